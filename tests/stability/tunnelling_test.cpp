#include "support/solvers/stable_step.h"
#include "support/worlds/drivers.h"

namespace pliant {
namespace {

// Obstacles 1 mm thin, passed within a fraction of a step: 5 m/s are 25 mm in 5 ms. Contact is
// without bounce and takes energy, so the cloth never gets faster than what hits it.
class Tunnelling : public EverySolver {
 protected:
  ClothScene scene(const Obstacle& thin) const {
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {thin};
    scene.effects = {{"contact", {{"thickness", "0.002"}}}};
    scene.solver = solver();
    return scene;
  }

  static void move_up(World& world, double seconds) {
    const Eigen::Isometry3d start = world.obstacles()[0].pose_end;
    const Eigen::Vector3d velocity(0, 0, 5);
    world.add_driver(std::make_unique<StraightDriver>(0, start, velocity, seconds));
  }
};

// A hand wider than the cloth comes from below at 5 m/s and stops: the cloth stays above it
// throughout, is carried along, and flies on at the hand's speed.
TEST_P(Tunnelling, HandAtFiveMetresPerSecondCarriesTheCloth) {
  const Obstacle hand = obstacle(Box({0.4, 0.4, 0.001}), at(0, 0, -0.1));
  const auto world = make_stable_world(scene(hand));
  move_up(*world, 0.1);
  while (world->time() < 0.15) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    const double top = world->obstacles()[0].pose_end.translation().z() + 0.0005;
    ASSERT_GT(lowest(*world), top + 0.001 - 1e-9) << world->time();
    ASSERT_LT(largest_speed(*world), 5.0 + 1e-6) << world->time();
  }
  EXPECT_NEAR(particles_of(*world).v.row(2).mean(), 5.0, 1e-6);
}

// The cloth drapes over the hand's edges; what was above its middle stays there.
TEST_P(Tunnelling, HandSmallerThanTheClothLeavesNoneBehind) {
  const Obstacle hand = obstacle(Box({0.12, 0.12, 0.001}), at(0, 0, -0.05));
  const auto world = make_stable_world(scene(hand));
  move_up(*world, 0.04);
  std::vector<int> above;  // particles over the hand's inner part, where none can slip off its edge
  for (int i = 0; i < particles_of(*world).size(); ++i) {
    if (particles_of(*world).x.col(i).head<2>().cwiseAbs().maxCoeff() < 0.04) above.push_back(i);
  }
  ASSERT_FALSE(above.empty());
  while (world->time() < 0.05) {
    ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
    const double top = world->obstacles()[0].pose_end.translation().z() + 0.0005;
    for (int i : above) ASSERT_GT(particles_of(*world).x(2, i), top + 0.001 - 1e-9) << i;
  }
}

// Thrown at a fixed plate, tilted, so that its particles arrive one after the other. Nothing gives
// energy, so none may come.
TEST_P(Tunnelling, ClothThrownAtAThinPlateStops) {
  for (double speed : {10.0, 50.0}) {
    ClothScene scene = this->scene(obstacle(Box({2.0, 2.0, 0.001})));
    scene.pose = at(0, 0, 0.2) * Eigen::AngleAxisd(0.5, Eigen::Vector3d(0.6, 0.8, 0));
    scene.time_step = !is_explicit(solver()) ? 0.005 : 0.5 * stable_step(scene);
    const auto world = make_world(scene);
    particles_of(*world).v.row(2).setConstant(-speed);
    const double energy = world->energies().total();
    while (world->time() < 0.1) {
      ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
      ASSERT_GT(lowest(*world), 0.0015 - 1e-9) << speed << " m/s at " << world->time();
      ASSERT_LE(world->energies().total(), energy_swing(solver()) * energy) << speed;
    }
  }
}

PLIANT_FOR_EVERY_SOLVER(Tunnelling);

}  // namespace
}  // namespace pliant
