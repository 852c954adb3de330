#include "pliant/solvers/iterations/xpbd.h"

namespace pliant {

void XpbdSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  mobility_ = dt * dt * system.particles.inverse_mass;
  objective_.prepare(system, dt);
}

void XpbdSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& particles = system.particles;
  for (const auto& set : system.elements) set->reset_multipliers();
  reset_constraints(system);
  objective_.begin_step(system);
  const auto residual = [&] {
    objective_.forces(system, forces_, report);
    return objective_.relative_residual(system, forces_, report.iterations);
  };
  StopCheck stop(rule(), report);
  do {
    while (stop.next()) {
      if (stop.wants_residual(!system.constraints.empty())) {
        const double share = residual();
        const bool asked = system.constraints.empty() || report.iterations > 1;
        if (stop.converged(asked ? share : 1.0)) break;
      }
      for (const auto& set : system.elements) {
        ScopedPhase phase(report, set->name());
        set->relax(particles.inverse_mass, dt, particles.x);
      }
      relax_constraints(system, mobility_, report);
    }
  } while (finds_more(system, report) && stop.go_on());
  if (stop.is_residual_old()) stop.set_residual(residual());
  stop.warn_unless_converged();
  if (!estimates_error()) stop.warn_of_large_residual();
  end_step(system, report.iterations > 0 ? held_.settle(system, mobility_, dt) : mobility_, report);
}

SolverRegistry::Entry xpbd_entry() {
  return {
      "xpbd",
      "compliant constraints by Gauss-Seidel sweeps; stable at any step, stiffens with iterations",
      stop_rule_parameters("20"), projective_models(), [](const Parameters& parameters) {
        return std::make_unique<XpbdSolver>(stop_rule(parameters));
      }};
}

}  // namespace pliant
