#include "pliant/solvers/jacobi.h"

#include <cmath>

namespace pliant {

void JacobiSolver::prepare_iterations(const ProjectiveSystem& system) {
  relaxation_ = make_relaxation(matrix(), system.particles);
}

void JacobiSolver::begin_iterations(ProjectiveSystem&, StepReport& report) {
  report.add_figure("relaxation", relaxation_.gamma);
}

bool JacobiSolver::iterate(ProjectiveSystem& system, StepReport& report) {
  jacobi_update(system, relaxation_.mobility, report);
  return true;
}

double JacobiSolver::iterations_for_a_tenth(double stiffness_ratio) const {
  return std::log(0.1) / std::log(relaxation_.spectral_radius(stiffness_ratio));
}

SolverRegistry::Entry jacobi_entry() {
  return {"jacobi",
          "projective dynamics by Jacobi iterations; never diverges, slow on stiff or fine bodies",
          stop_rule_parameters("50"), projective_models(), [](const Parameters& parameters) {
            return std::make_unique<JacobiSolver>(stop_rule(parameters));
          }};
}

}  // namespace pliant
