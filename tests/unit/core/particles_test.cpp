#include "pliant/core/body/particles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

Particles two_particles() {
  Positions x(3, 2);
  x << 1, 0, 0, 2, 0, 0;
  Particles particles(x, Eigen::Vector2d(2.0, 3.0));
  particles.v << 0, -1, 1, 0, 0, 0;
  return particles;
}

TEST(Particles, StartAtRest) {
  const Particles particles(Positions::Ones(3, 4), Eigen::VectorXd::Constant(4, 0.5));
  EXPECT_EQ(particles.size(), 4);
  EXPECT_TRUE(particles.v.isZero(0.0));
  EXPECT_EQ(particles.x_start, particles.x);
  EXPECT_EQ(particles.inverse_mass, Eigen::VectorXd::Constant(4, 2.0));
  EXPECT_EQ(particles.kinetic_energy(), 0.0);
}

TEST(Particles, MomentaAndEnergy) {
  const Particles particles = two_particles();
  EXPECT_EQ(particles.momentum(), Eigen::Vector3d(-3, 2, 0));
  // 2 (1, 0, 0) x (0, 1, 0) + 3 (0, 2, 0) x (-1, 0, 0)
  EXPECT_EQ(particles.angular_momentum(), Eigen::Vector3d(0, 0, 8));
  EXPECT_EQ(particles.kinetic_energy(), 2.5);
  EXPECT_TRUE(particles.center_of_mass().isApprox(Eigen::Vector3d(0.4, 1.2, 0), 1e-15));
}

TEST(Particles, FixingStopsAndReleasingFrees) {
  Particles particles = two_particles();
  particles.fix(1);
  EXPECT_TRUE(particles.is_fixed(1));
  EXPECT_FALSE(particles.is_fixed(0));
  EXPECT_TRUE(particles.v.col(1).isZero(0.0));
  EXPECT_EQ(particles.mass[1], 3.0);
  particles.release(1);
  EXPECT_FALSE(particles.is_fixed(1));
  EXPECT_EQ(particles.inverse_mass[1], 1.0 / 3.0);
}

TEST(Particles, RefusesBadMassesByNumber) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, inf, -inf, std::nan("")}) {
    expect_refusal([&] { Particles(Positions::Zero(3, 2), Eigen::Vector2d(1.0, bad)); },
                   {"mass of particle 1", "kg", "positive"});
  }
}

TEST(Particles, NoneAreAllowed) {
  const Particles none(Positions(3, 0), Eigen::VectorXd(0));
  EXPECT_EQ(none.size(), 0);
  EXPECT_EQ(none.kinetic_energy(), 0.0);
  EXPECT_TRUE(none.momentum().isZero(0.0));
}

}  // namespace
}  // namespace pliant
