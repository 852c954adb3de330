#include "pliant/solvers/jacobi.h"

#include "pliant/core/parallel.h"

namespace pliant {
namespace {
constexpr int kGrain = 4096;
}

void JacobiSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  const Particles& particles = system.particles;
  AbsoluteRowSums rows(particles.size());
  for (const auto& set : system.elements) set->add_to_system(rows);
  mobility_ = (particles.mass / (dt * dt) + rows.sums()).cwiseInverse();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) mobility_[i] = 0.0;
  }
  before_.resize(3, particles.size());
}

void JacobiSolver::solve(ProjectiveSystem& system, double dt, StepReport& report) {
  Particles& particles = system.particles;
  predicted_ = particles.x;
  reset_couplings(system);
  StopCheck stop(stop_, report);
  while (stop.next()) {
    const bool measure = stop.wants_displacement();
    if (measure) before_ = particles.x;
    forces_.setZero(3, particles.size());
    for (const auto& set : system.elements) {
      ScopedPhase phase(report, set->name());
      set->add_forces(particles.x, forces_);
    }
    update(particles, dt);
    reset_couplings(system);
    relax_couplings(system, mobility_, report);
    if (measure) stop.set_displacement((particles.x - before_).norm());
  }
  finish_couplings(system, mobility_, report);
}

void JacobiSolver::update(Particles& particles, double dt) {
  const double inverse_dt2 = 1.0 / (dt * dt);
  parallel_for(0, particles.size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      // x += D^-1 (m/h² (y - x) + f)
      const double inertia = particles.mass[i] * inverse_dt2;
      particles.x.col(i) +=
          mobility_[i] * (inertia * (predicted_.col(i) - particles.x.col(i)) + forces_.col(i));
    }
  });
}

SolverRegistry::Entry jacobi_entry() {
  return {"jacobi",
          "projective dynamics by Jacobi iterations; never diverges, slow on stiff or fine bodies",
          stop_rule_parameters("50"),
          {"cloth"},
          [](const Parameters& parameters) {
            return std::make_unique<JacobiSolver>(stop_rule(parameters));
          }};
}

}  // namespace pliant
