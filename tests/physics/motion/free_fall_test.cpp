// Free fall and ballistic motion: exact against the closed form of the discrete scheme, and of the
// order of the integrator against the parabola.
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant::free_fall_test {
namespace {

const Eigen::Vector3d kGravity(0, 0, -9.81);
const Eigen::Vector3d kVelocity(2, -1, 5);

class FreeFall : public EverySolver {
 protected:
  std::unique_ptr<World> thrown(double dt, const Eigen::Vector3d& velocity) const {
    ClothScene s;
    s.solver = GetParam();
    s.material = soft_material();
    s.time_step = dt;
    s.effects = {{"gravity", {}}};
    auto world = make_world(s);
    particles_of(*world).v.colwise() = velocity;
    return world;
  }

  /// Largest distance from the parabola after `seconds`.
  double error(double dt, double seconds, const Eigen::Vector3d& velocity) const {
    auto world = thrown(dt, velocity);
    const Positions start = particles_of(*world).x;
    run_for(*world, seconds);
    const Eigen::Vector3d displacement = seconds * kVelocity + 0.5 * seconds * seconds * kGravity;
    return ((particles_of(*world).x - start).colwise() - displacement).colwise().norm().maxCoeff();
  }
};
PLIANT_FOR_EVERY_SOLVER(FreeFall);

TEST_P(FreeFall, BeginsAtOnceWhenWhatItLayOnIsGone) {
  const double h = 1e-3;
  ClothScene s;
  s.solver = GetParam();
  s.material = soft_material();
  s.time_step = h;
  s.obstacles = {obstacle(Plane(), at(0, 0, -0.001))};
  s.effects = {{"gravity", {}}, {"contact", {{"thickness", "0.002"}}}};
  const auto world = make_world(s);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step());
  ASSERT_GT(body_of(*world).report.contacts, 0);
  const double before = particles_of(*world).v.row(2).mean();
  Obstacle& plane = world->obstacles()[0];
  plane.pose_start = plane.pose_end = at(0, 0, -100);
  for (int k = 1; k <= 20; ++k) {
    ASSERT_TRUE(world->step());
    EXPECT_NEAR(particles_of(*world).v.row(2).mean() - before, -9.81 * k * h, 1e-9) << k;
  }
}

TEST_P(FreeFall, FollowsTheDiscreteSchemeExactly) {
  const double h = 1e-3;
  const int steps = 400;
  auto world = thrown(h, kVelocity);
  const Positions start = particles_of(*world).x;
  run_for(*world, steps * h);
  // v_n = v_0 + n h g,  x_n = x_0 + n h v_0 + n (n + 1) / 2 h² g
  const Eigen::Vector3d displacement =
      steps * h * kVelocity + 0.5 * steps * (steps + 1) * h * h * kGravity;
  const Eigen::Vector3d velocity = kVelocity + steps * h * kGravity;
  const Particles& p = particles_of(*world);
  // Each step rounds positions of about 1 m to 1e-16 m, velocities to that over h; velocities sum
  // the errors of n steps, positions those of n² steps.
  EXPECT_LE((p.v.colwise() - velocity).cwiseAbs().maxCoeff(), 1e-16 * 2.0 / h * steps);
  EXPECT_LE(((p.x - start).colwise() - displacement).cwiseAbs().maxCoeff(),
            1e-16 * 2.0 * steps * steps);
}

TEST_P(FreeFall, IsOfFirstOrder) {
  // x_n misses the parabola by t h g / 2.
  for (const double h : {0.002, 0.001, 0.0005}) {
    EXPECT_NEAR(error(h, 0.4, kVelocity), 0.5 * 0.4 * h * 9.81, 1e-9);
  }
}

TEST_P(FreeFall, IsExactWithTheVelocityOfTheHalfStep) {
  // Verlet's own velocity, (x_n - x_{n-1}) / h, lives half a step back.
  for (const double h : {0.002, 0.001, 0.0005}) {
    EXPECT_LE(error(h, 0.4, kVelocity - 0.5 * h * kGravity), 1e-10);
  }
}

TEST_P(FreeFall, DoesNotStrainTheCloth) {
  auto world = thrown(1e-3, kVelocity);
  run_for(*world, 0.4);
  EXPECT_LE(world->energies().elastic, 1e-18);
}

}  // namespace
}  // namespace pliant::free_fall_test
