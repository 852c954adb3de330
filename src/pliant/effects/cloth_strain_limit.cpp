#include "pliant/effects/cloth_strain_limit.h"

#include <fmt/format.h>

#include "pliant/core/body.h"

namespace pliant {
namespace {

// Sweeps in each of a solver's iterations, and after them at the most.
constexpr int kSweeps = 1, kLastSweeps = 120, kSettlingSweeps = 4;
// Beyond the limit, as a share of a thread's length: what the last sweeps may leave, and what a
// user is told of.
constexpr double kLeftOver = 1e-3, kTold = 0.01;

}  // namespace

ClothStrainLimit::ClothStrainLimit(const ProjectiveSystem& system, double max)
    : max_(max), limits_(system.elements, system.particles.size(), max) {}

void ClothStrainLimit::begin_step(const Particles& particles, double dt) {
  limits_.begin_step(particles);
  free_mobility_ = dt * dt * particles.inverse_mass;
}

void ClothStrainLimit::relax(const Eigen::VectorXd& mobility, Positions& x) {
  limits_.relax(mobility, kSweeps, 0.0, x);
}

void ClothStrainLimit::finish(const Eigen::VectorXd&, Positions& x) {
  // Nothing undoes what this moves: by the masses it keeps momentum.
  limits_.relax(free_mobility_, kLastSweeps, kLeftOver, x);
}

double ClothStrainLimit::settle(const Eigen::VectorXd&, Positions& x) {
  return limits_.relax(free_mobility_, kSettlingSweeps, kLeftOver, x) / kLeftOver;
}

void ClothStrainLimit::after_step(Body& body, double) {
  const double strain = limits_.largest_strain(body.particles().x);
  body.report.add_figure("largest_strain", strain);
  if (!(strain > max_ - 1.0 + kTold)) return;
  body.report.warn(fmt::format(
      "strain_limit: {:.1f} % where {:.1f} % is the limit: what holds or presses the cloth leaves "
      "it no room, or moves it too far in one step; take a smaller time step",
      100.0 * strain, 100.0 * (max_ - 1.0)));
}

void ClothStrainLimit::reset(Body&) { limits_.reset_multipliers(); }

}  // namespace pliant
