#include "pliant/solvers/implicit_euler.h"

#include <algorithm>

#include "pliant/core/parallel.h"

namespace pliant {
namespace {
constexpr int kGrain = 4096;
// Times more iterations than there are, beyond which another solver is the better advice.
constexpr double kTooMany = 10.0;
// An acceleration from two velocities is known no better: in free fall the prediction is exact.
constexpr double kRoundOff = 1e-9;
}  // namespace

void ImplicitEulerSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  matrix_ = projective_matrix(system, dt);
  objective_.prepare(system, dt);
  prepare_iterations(system);
}

void ImplicitEulerSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  objective_.begin_step(system);
  // Not where nothing can hold the body up: too few iterations would gain energy by it.
  const bool may_rest = !system.couplings.empty() && report.step > 1;
  if (rule_.iterations > 0 && may_rest) start_near_solution(system, dt);
  reset_couplings(system);
  begin_iterations(system, report);
  StopCheck stop(rule_, report);
  while (stop.next()) {
    compute_forces(system, report);
    if (stop.wants_residual(!system.couplings.empty())) {
      const double residual = objective_.relative_residual(system, forces_, report.iterations);
      // Before couplings are asked, that nothing pulls says nothing of what is in the way.
      const bool asked =
          system.couplings.empty() || report.iterations > 1 || asks_couplings_first();
      if (stop.converged(asked ? residual : 1.0)) break;
    }
    if (!iterate(system, report)) stop.stall();
  }
  if (stop.is_residual_old()) {
    compute_forces(system, report);
    stop.set_residual(objective_.relative_residual(system, forces_, report.iterations));
  }
  stop.warn_unless_converged();
  warn_of_stiffness(report);
  end_iterations(system, report);
  finish_couplings(system, mobility(), report);
}

void ImplicitEulerSolver::start_near_solution(ProjectiveSystem& system, double dt) const {
  Particles& p = system.particles;
  parallel_for(0, p.size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (p.is_fixed(i)) continue;
      const Eigen::Vector3d external = p.inverse_mass[i] * system.external_forces.col(i);
      const double squared = external.squaredNorm();
      if (squared == 0.0) continue;
      const double along = (p.v_start.col(i) - p.v_before.col(i)).dot(external) / (dt * squared);
      if (along > 1.0 - kRoundOff) continue;
      p.x.col(i) -= (1.0 - std::max(along, 0.0)) * dt * dt * external;
    }
  });
}

void ImplicitEulerSolver::warn_of_stiffness(StepReport& report) const {
  if (report.ended_by != EndedBy::kIterations || report.iterations == 0) return;
  const double needed = iterations_for_a_tenth(objective_.stiffness_ratio());
  if (needed <= kTooMany * report.iterations) return;
  report.warn(
      "stiffness_ratio_too_high: use direct or lbfgs, which such stiff or fine bodies do not slow "
      "down, or many more iterations; the body is softer than its material says");
}

void ImplicitEulerSolver::jacobi_update(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                        StepReport& report) {
  Positions& x = system.particles.x;
  parallel_for(0, static_cast<int>(x.cols()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) x.col(i) += mobility[i] * forces_.col(i);
  });
  reset_couplings(system);
  relax_couplings(system, mobility, report);
}

}  // namespace pliant
