#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant {

/// A world's state, to be compared with what it is later.
struct Snapshot {
  explicit Snapshot(World& world)
      : x(particles_of(world).x), v(particles_of(world).v), time(world.time()) {}

  /// Bit for bit, so that NaN equals itself.
  void expect_equal(World& world) const {
    const Particles& particles = particles_of(world);
    EXPECT_EQ(time, world.time());
    EXPECT_TRUE(same_bits(x, particles.x)) << "positions";
    EXPECT_TRUE(same_bits(v, particles.v)) << "velocities";
  }

  static bool same_bits(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
    return a.cols() == b.cols() &&
           std::equal(a.data(), a.data() + a.size(), b.data(), [](double p, double q) {
             return p == q || (std::isnan(p) && std::isnan(q));
           });
  }

  Eigen::Matrix3Xd x, v;
  double time;
};

}  // namespace pliant
