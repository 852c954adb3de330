#include "pliant/solvers/direct.h"

namespace pliant {

void DirectSolver::prepare_iterations(const ProjectiveSystem& system) {
  FactoredSolver::prepare_iterations(system);
  cholesky_.factor(matrix());
}

bool DirectSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  if (!begin_correction(system, report)) return true;
  {
    ScopedPhase phase(report, "global");
    coupled().solve(
        rows(), system.particles,
        [this](Eigen::Matrix3Xd& v) {
          multiply(matrix(), v, product_);
          v.swap(product_);
        },
        [this](Eigen::Matrix3Xd& v) { cholesky_.solve(v); }, correction());
  }
  if (system.couplings.empty()) {
    system.particles.x += correction();
  } else {
    // What couplings hold is linearised: the full step need not lower the objective any more.
    ScopedPhase phase(report, "line_search");
    start_ = system.particles.x;
    search(system, start_);
  }
  end_correction(system, report);
  return true;
}

void DirectSolver::end_iterations(ProjectiveSystem& system, StepReport& report) {
  FactoredSolver::end_iterations(system, report);
  report.add_figure("factor_nonzeros", static_cast<double>(cholesky_.nonzeros()));
}

SolverRegistry::Entry direct_entry() {
  return {
      "direct",
      "projective dynamics with a Cholesky factor made once; exact global steps, stiff and fine "
      "bodies; a new factor when masses, pins or the time step change",
      stop_rule_parameters("10"), projective_models(), [](const Parameters& parameters) {
        return std::make_unique<DirectSolver>(stop_rule(parameters));
      }};
}

}  // namespace pliant
