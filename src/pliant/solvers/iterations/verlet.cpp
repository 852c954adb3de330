#include "pliant/solvers/iterations/verlet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {
namespace {

// Rounding of dt / substeps must neither ask for another substep nor warn.
constexpr double kRounding = 1e-9;

}  // namespace

void VerletSolver::prepare_system(const ProjectiveSystem& system, double dt) {
  const Particles& particles = system.particles;
  for (const auto& set : system.elements) {
    if (!set->is_viscous()) continue;
    throw InputError(
        "'verlet' is explicit and cannot damp a material: leave out 'damping' of the material, or "
        "take an implicit solver, for example 'lbfgs', or the effect 'damping'");
  }
  mobility_ = dt * dt * particles.inverse_mass;
  AbsoluteRowSums rows(particles.size());
  for (const auto& set : system.elements) set->add_to_system(rows);
  // omega² <= max_i (absolute row sum of M^-1 K), by Gershgorin.
  const double omega2 =
      particles.size() == 0 ? 0.0 : rows.sums().cwiseProduct(particles.inverse_mass).maxCoeff();
  stable_step_ = 2.0 / std::sqrt(omega2);
  warning_.clear();
  if (dt > (1.0 + kRounding) * stable_step_) {
    warning_ = fmt::format(
        "unstable_step: {:g} s is above the largest step that is surely stable with verlet, {:g} "
        "s: allow more substeps (max_substeps of the solver), or take a smaller time step",
        dt, stable_step_);
  }
}

int VerletSolver::substeps_of_step(double dt) const {
  const double substeps = std::ceil((1.0 - kRounding) * dt / stable_step_);
  return static_cast<int>(std::clamp(substeps, 1.0, static_cast<double>(max_substeps_)));
}

void VerletSolver::add_predicted_forces(const ProjectiveSystem& system, Forces& forces) const {
  for (const auto& set : system.elements) set->add_forces(system.particles.x, forces);
}

void VerletSolver::solve(ProjectiveSystem& system, double, StepReport& report) {
  if (!warning_.empty()) report.warn(warning_);
  report.iterations = 1;
  reset_constraints(system);
  for (int sweep = 0; sweep < contact_sweeps_; ++sweep)
    relax_constraints(system, mobility_, report);
  end_step(system, mobility_, report);
}

SolverRegistry::Entry verlet_entry() {
  return {"verlet",
          "explicit Verlet steps, as in the cloth thesis; cheap steps, but small ones",
          {integer_parameter("contact_sweeps", "2", 1, 1000,
                             "passes over contacts and air in one step"),
           renamed(integer_parameter(
                       "max_substeps", "1000", 1, 1e6,
                       "most substeps that a step is taken in where the whole of it is above the "
                       "largest step that is surely stable; 1: whole steps, stable or not"),
                   "max_parts")},
          deformable_models(),
          [](const Parameters& parameters) {
            return std::make_unique<VerletSolver>(parameters.integer("contact_sweeps"),
                                                  parameters.integer("max_substeps"));
          }};
}

}  // namespace pliant
