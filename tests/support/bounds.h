#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "pliant/elements/spring_set.h"
#include "support/worlds.h"

namespace pliant {

/// Largest distance of a vertex from the origin [m].
inline double extent(World& world) {
  return particles_of(world).x.colwise().norm().maxCoeff();
}

/// Steps `count` times; every state must be finite and within `bound` [m] of the origin.
inline void expect_bounded(World& world, int count, double bound) {
  for (int k = 0; k < count; ++k) {
    ASSERT_TRUE(world.step()) << body_of(world).report.failure;
    ASSERT_TRUE(particles_of(world).x.allFinite());
    ASSERT_TRUE(particles_of(world).v.allFinite());
    ASSERT_LE(extent(world), bound) << "step " << k;
  }
}

/// Whether the last report holds a warning that begins with `name`.
inline bool warned(World& world, const std::string& name) {
  const auto& warnings = body_of(world).report.warnings;
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& warning) { return warning.rfind(name, 0) == 0; });
}

/// Largest strain of any stretch spring.
inline double largest_strain(World& world) {
  double largest = 0.0;
  auto& system = dynamic_cast<ProjectiveSystem&>(body_of(world).model->system());
  for (const auto& set : system.elements) {
    const auto* springs = dynamic_cast<const SpringSet*>(set.get());
    if (springs == nullptr || springs->name() != "stretch") continue;
    largest = std::max(largest, springs->strains(particles_of(world).x).maxCoeff());
  }
  return largest;
}

/// A cloth of default fabric on two corners.
inline ClothScene on_two_corners(const std::string& solver, double dt) {
  ClothScene s;
  s.solver = solver;
  s.time_step = dt;
  s.fixed = {0, 6};
  s.effects = {{"gravity", {}}, {"damping", {}}};
  return s;
}

/// A step that verlet surely holds for the default fabric on the default grid.
constexpr double kVerletStep = 2e-4;
inline double good_step(const std::string& solver) { return solver == "verlet" ? kVerletStep : 0.005; }

}  // namespace pliant
