#include "pliant/solvers/projective_solver.h"

#include <algorithm>
#include <limits>

#include "pliant/core/columns.h"

namespace pliant {
namespace {
// In which couplings settle what their last words did to each other.
constexpr int kMaxRounds = 20;
}  // namespace

void ProjectiveSolver::prepare(System& system, double dt) {
  prepare_system(static_cast<ProjectiveSystem&>(system), dt);
}

void ProjectiveSolver::step(System& system, double dt, StepReport& report) {
  begin_step(system, dt, report);
  finish_step(system, dt, report);
}

void ProjectiveSolver::begin_step(System& base, double dt, StepReport& report) {
  auto& system = static_cast<ProjectiveSystem&>(base);
  Particles& particles = system.particles;
  report.solver = name();
  {
    ScopedPhase phase(report, "predict");
    add_predicted_forces(system, system.external_forces);
    predict(system, dt);
  }
  for (Coupling* coupling : system.couplings) {
    ScopedPhase phase(report, coupling->name());
    coupling->begin_step(particles, dt);
  }
  begin_solve(system, dt, report);
}

void ProjectiveSolver::finish_step(System& base, double dt, StepReport& report) {
  auto& system = static_cast<ProjectiveSystem&>(base);
  solve(system, dt, report);
  ScopedPhase phase(report, "velocity");
  Particles& particles = system.particles;
  for_each_column(particles.x, [&](int i) {
    particles.v.col(i) = (particles.x.col(i) - particles.x_start.col(i)) / dt;
  });
  for (const Coupling* coupling : system.couplings) coupling->report(report);
}

void ProjectiveSolver::predict(ProjectiveSystem& system, double dt) {
  Particles& p = system.particles;
  p.x_start.swap(p.x);
  p.v_before.swap(p.v_start);
  p.v_start.swap(p.v);
  const Forces& f = system.external_forces;
  // x = x_start + h v + h² f / m; fixed particles stay.
  for_each_column(p.x, [&](int i) {
    const double w = p.inverse_mass[i];
    if (w == 0.0) {
      p.x.col(i) = p.x_start.col(i);
    } else {
      p.x.col(i) = p.x_start.col(i) + dt * (p.v_start.col(i) + dt * w * f.col(i));
    }
  });
}

void ProjectiveSolver::reset_couplings(ProjectiveSystem& system) {
  for (Coupling* coupling : system.couplings) coupling->reset_multipliers();
}

void ProjectiveSolver::relax_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                       StepReport& report) {
  for (Coupling* coupling : system.couplings) {
    ScopedPhase phase(report, coupling->name());
    coupling->relax(mobility, system.particles.x);
  }
}

void ProjectiveSolver::finish_couplings(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                                        StepReport& report) {
  for (Coupling* coupling : system.couplings) {
    ScopedPhase phase(report, coupling->name());
    coupling->finish(mobility, system.particles.x);
  }
  const auto& all = system.couplings;
  const bool must_settle =
      std::any_of(all.begin(), all.end(), [](const Coupling* c) { return c->needs_settling(); });
  double missed = must_settle ? std::numeric_limits<double>::infinity() : 0.0;
  for (int round = 0; round < kMaxRounds && missed > 1.0; ++round) {
    missed = 0.0;
    for (Coupling* coupling : all) {
      ScopedPhase phase(report, coupling->name());
      missed = std::max(missed, coupling->settle(mobility, system.particles.x));
    }
  }
}

const std::vector<std::string>& projective_models() {
  static const std::vector<std::string> models = {"cloth", "patch", "viscoelastic"};
  return models;
}

}  // namespace pliant
