#include "pliant/solvers/xpbd.h"

namespace pliant {

void XpbdSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  mobility_ = dt * dt * system.particles.inverse_mass;
  before_.resize(3, system.particles.size());
}

void XpbdSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& particles = system.particles;
  for (const auto& set : system.elements) set->reset_multipliers();
  reset_couplings(system);
  StopCheck stop(stop_, report);
  while (stop.next()) {
    const bool measure = stop.wants_displacement();
    if (measure) before_ = particles.x;
    for (const auto& set : system.elements) {
      ScopedPhase phase(report, set->name());
      set->relax(particles.inverse_mass, dt, particles.x);
    }
    relax_couplings(system, mobility_, report);
    if (measure) stop.set_displacement((particles.x - before_).norm());
  }
  finish_couplings(system, mobility_, report);
}

SolverRegistry::Entry xpbd_entry() {
  return {
      "xpbd",
      "compliant constraints by Gauss-Seidel sweeps; stable at any step, stiffens with iterations",
      stop_rule_parameters("20"),
      {"cloth"},
      [](const Parameters& parameters) {
        return std::make_unique<XpbdSolver>(stop_rule(parameters));
      }};
}

}  // namespace pliant
