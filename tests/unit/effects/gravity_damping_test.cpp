#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/worlds.h"

namespace pliant {
namespace {

class BodyForce : public EverySolver {
 protected:
  ClothScene scene() const {
    ClothScene scene;
    scene.solver = GetParam();
    scene.material = soft_material();
    scene.time_step = 1e-3;
    return scene;
  }
};
PLIANT_FOR_EVERY_SOLVER(BodyForce);

TEST_P(BodyForce, GravityAcceleratesEveryParticleAlike) {
  ClothScene s = scene();
  s.effects = {{"gravity", {{"acceleration", "[1, -2, 3]"}}}};
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  const Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) {
    EXPECT_TRUE(p.v.col(i).isApprox(1e-3 * Eigen::Vector3d(1, -2, 3), 1e-9));
  }
}

TEST_P(BodyForce, DampingDecaysExponentially) {
  ClothScene s = scene();
  s.effects = {{"damping", {{"rate", "7"}}}};
  auto world = make_world(s);
  particles_of(*world).v.row(1).setConstant(2.0);
  run_for(*world, 0.1);
  // Exact for any step: exp(-rate t); round-off of 1e-17 m over the step of 1e-3 s, 100 times.
  const Eigen::VectorXd speed = particles_of(*world).v.row(1);
  EXPECT_TRUE(speed.isApproxToConstant(2.0 * std::exp(-0.7), 1e-11));
}

TEST_P(BodyForce, NoDampingAtRateZero) {
  ClothScene s = scene();
  s.effects = {{"damping", {{"rate", "0"}}}};
  auto with = make_world(s);
  s.effects.clear();
  auto without = make_world(s);
  for (auto* world : {with.get(), without.get()}) {
    particles_of(*world).v(2, 10) = 1.0;
    run_for(*world, 0.05);
  }
  EXPECT_EQ(particles_of(*with).x, particles_of(*without).x);
}

TEST(Gravity, PotentialEnergyIsRelativeToTheOrigin) {
  ClothScene s;
  s.pose = at(0, 3.0, 2.0);
  s.effects = {{"gravity", {{"acceleration", "[0, -4, -10]"}}}};
  auto world = make_world(s);
  EXPECT_NEAR(world->energies().potential, 0.15 * 0.09 * (20.0 + 12.0), 1e-12);
}

}  // namespace
}  // namespace pliant
