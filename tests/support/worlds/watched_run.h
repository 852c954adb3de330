#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "support/measures.h"

namespace pliant {

/// Steps until `seconds` are over and returns the largest total energy seen, the start's included.
inline double largest_energy(World& world, double seconds) {
  double largest = world.energies().total();
  const double end = world.time() + seconds - 0.5 * world.time_step();
  while (world.time() < end) {
    if (!world.step()) {
      ADD_FAILURE() << body_of(world).report.failure;
      break;
    }
    largest = std::max(largest, world.energies().total());
  }
  return largest;
}

/// Steps until `seconds` are over: what moves must have no other source than the energy of the
/// start and the work of gravity. Too few iterations make a cloth softer than it is, so that it may
/// store more elastic energy than there is, but never more lively.
inline void expect_no_free_motion(World& world, double seconds, double slack = 0.0) {
  const double start = world.energies().total();
  const double end = world.time() + seconds - 0.5 * world.time_step();
  while (world.time() < end) {
    ASSERT_TRUE(world.step()) << body_of(world).report.failure;
    const Energies now = world.energies();
    ASSERT_LE(now.kinetic + now.potential, start + slack) << "at " << world.time() << " s";
  }
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

}  // namespace pliant
