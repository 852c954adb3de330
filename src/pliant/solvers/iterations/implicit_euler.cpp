#include "pliant/solvers/iterations/implicit_euler.h"

#include <algorithm>
#include <limits>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/iterations/first_iterate.h"

namespace pliant {
namespace {
constexpr int kGrain = 1024;
// An iteration that leaves this share of what the one before it left has bettered nothing.
constexpr double kNoBetter = 1.0;
// Times round-off, that settled contact forces may leave from one iteration to the next.
constexpr double kLittleMore = 4.0;
}  // namespace

void ImplicitEulerSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  product_.assemble(system, dt);
  if (needs_matrix() && product_.shares()) matrix_ = projective_matrix(system, dt);
  objective_.prepare(system, dt);
  prepare_iterations(system);
}

void ImplicitEulerSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  objective_.begin_step(system);
  if (rule().iterations > 0 && report.step > 1) start_near_solution(system, dt);
  if (begins_rigidly(system)) {
    const ScopedPhase phase(report, "momentum");
    momentum().begin(system, objective_, mobility(), dt);
  }
  reset_constraints(system);
  begin_iterations(system, report);
  StopCheck stop(rule(), report);
  iterate_to_end(system, stop, report);
  while (finds_more(system, report) && stop.go_on()) {
    go_on();
    iterate_to_end(system, stop, report);
  }
  if (report.ended_by != EndedBy::kTolerance) judge_last_iteration(system, report);
  if (stop.is_residual_old()) {
    compute_forces(system, report);
    stop.set_residual(relative_residual(system, report));
  }
  // What an asked error is met by is told by its estimate, where there is one.
  if (!asks_for_error() || !estimates_error()) stop.warn_unless_converged();
  if (!estimates_error()) stop.warn_of_large_residual();
  // Without iterations nobody found what the forces of the last step became.
  if (report.iterations == 0) reset_constraints(system);
  choose_end(system, report);
  if (report.iterations > 0 && may_take_again(system, report) && gains_energy(system, report))
    take_again(system, report);
  end_iterations(system, report);
  end_step(system, mobility(), report);
}

void ImplicitEulerSolver::iterate_to_end(ProjectiveSystem& system, StopCheck& stop,
                                         StepReport& report) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  double round_off = kUnknown;  // the last residual, where that was round-off
  while (stop.next()) {
    compute_forces(system, report);
    const bool may_be_done =
        ends_at_round_off() && (round_off < kUnknown || stop.may_be_round_off());
    if (stop.wants_residual(!system.constraints.empty()) || may_be_done) {
      const double residual = relative_residual(system, report);
      // Before constraints are asked, that nothing pulls says nothing of what is in the way.
      const bool asked =
          system.constraints.empty() || report.iterations > 1 || asks_constraints_first();
      if (stop.converged(asked ? residual : 1.0)) {
        // What they were asked first is all that the step takes, and their forces stand.
        if (!system.constraints.empty()) report.iterations = std::max(1, report.iterations);
        break;
      }
      const double left = objective_.last_residual();
      // The estimate of round-off is a high one: iterations may still better what is below it. What
      // they leave of contact forces that are settled may rise above it and fall again.
      const bool is_no_better = may_be_done && left >= kNoBetter * round_off;
      if (is_no_better && objective_.is_round_off(left / kLittleMore)) {
        stop.end_at_round_off();
        break;
      }
      round_off = may_be_done && residual == 0.0 ? left : kUnknown;
    }
    if (!iterate(system, report)) stop.stall();
  }
}

double ImplicitEulerSolver::relative_residual(ProjectiveSystem& system, StepReport& report) {
  find_squared_violations(system, violations_);
  return objective_.relative_residual(system, forces_, report.iterations, violations_);
}

void ImplicitEulerSolver::jacobi_update(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                        StepReport& report) {
  Positions& x = system.particles.x;
  parallel_for(0, static_cast<int>(x.cols()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) x.col(i) += mobility[i] * forces_.col(i);
  });
  reset_constraints(system);
  relax_constraints(system, mobility, report);
}

}  // namespace pliant
