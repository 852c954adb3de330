#include "pliant/effects/strain_limit/cloth_strain_limit.h"

#include <fmt/format.h>

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/math/rounded_percent.h"

namespace pliant {
namespace {

// Beyond the limit, as a share of a yarn's length: what the final projection may leave, and what a
// user is told of.
constexpr double kLeftOver = 2.5e-3, kTold = 0.01;

/// What attachments hold at present, by particle; what several hold as firmly as they are together.
void find_held(const ProjectiveSystem& system, std::vector<HeldVertex>& held) {
  held.clear();
  for (const auto& set : system.elements) set->add_held(held);
  std::sort(held.begin(), held.end(),
            [](const HeldVertex& a, const HeldVertex& b) { return a.particle < b.particle; });
  std::size_t kept = 0;
  for (const HeldVertex& vertex : held) {
    if (kept > 0 && held[kept - 1].particle == vertex.particle) {
      held[kept - 1].stiffness += vertex.stiffness;
    } else {
      held[kept++] = vertex;
    }
  }
  held.resize(kept);
}

}  // namespace

ClothStrainLimit::ClothStrainLimit(const ProjectiveSystem& system, double max)
    : system_(system), max_(max), limits_(system.elements, system.particles.size(), max) {}

void ClothStrainLimit::begin_step(const Particles& particles, double dt) {
  find_held(system_, held_);
  limits_.begin_step(particles, held_);
  free_mobility_ = dt * dt * particles.inverse_mass;
  // What is held gives way as its spring does, implicitly: 1 / (m/h² + k).
  for (const HeldVertex& vertex : held_) {
    double& own = free_mobility_[vertex.particle];
    own /= 1.0 + vertex.stiffness * own;
  }
}

void ClothStrainLimit::relax(const Eigen::VectorXd& mobility, Positions& x) {
  limits_.relax(mobility, x);
}

void ClothStrainLimit::final_projection(const Eigen::VectorXd&, Positions& x) {
  // Nothing undoes what this moves: by the masses it keeps momentum.
  providers_.clear();
  for (Constraint* constraint : system_.constraints) {
    if (auto* provider = constraint->find<LinearConstraintProvider>()) {
      providers_.push_back(provider);
    }
  }
  limits_.hold(free_mobility_, kLeftOver, providers_, x);
}

double ClothStrainLimit::alternating_projection(const Eigen::VectorXd&, Positions& x) {
  return limits_.alternating_projection(free_mobility_, kLeftOver, x) / kLeftOver;
}

void ClothStrainLimit::after_step(Body& body, double) {
  const double strain = limits_.largest_strain(body.particles().x);
  body.report.add_metric("largest_strain", strain);
  if (!(strain > max_ - 1.0 + kTold)) return;
  body.report.warn(fmt::format(
      "strain_limit: about {} % where {:.1f} % is the limit: what holds or presses the cloth "
      "leaves it no room, or moves it too far in one step; take a smaller time step",
      rounded_percent(strain), 100.0 * (max_ - 1.0)));
}

void ClothStrainLimit::reset(Body&) { limits_.reset_multipliers(); }

}  // namespace pliant
