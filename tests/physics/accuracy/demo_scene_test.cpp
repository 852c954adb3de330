// The demo's arm holds its soft rabbit by friction alone, and feels what it weighs.
#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/scene/scene.h"

namespace pliant::demo_scene_test {
namespace {

/// The demo without its towel, which nothing touches until the rabbit is laid down.
std::unique_ptr<World> rabbit_alone() {
  SceneSpec spec = read_scene(std::string(PLIANT_SOURCE_DIR) + "/config/scenes/demo.yaml");
  const auto erase = [](auto& list, const auto& is_out) {
    list.erase(std::remove_if(list.begin(), list.end(), is_out), list.end());
  };
  erase(spec.bodies, [](const BodySpec& body) { return body.name != "rabbit"; });
  erase(spec.effects, [](const NamedParameters& effect) {
    return effect.name == "air" || effect.name == "wetness";
  });
  return build_world(spec);
}

const Particles& rabbit_of(const World& world) { return world.bodies().front().particles(); }

Eigen::Vector3d center_of(const World& world) {
  const Particles& particles = rabbit_of(world);
  return particles.x * particles.mass / particles.mass.sum();
}

/// What the bodies do to the links whose name ends with `ending`, in the last step [N].
Eigen::Vector3d force_on(const World& world, const std::string& ending) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t o = 0; o < world.obstacles().size(); ++o) {
    const std::string& link = world.obstacles()[o].link;
    const std::size_t found = link.rfind(ending);
    if (found == std::string::npos || found + ending.size() != link.size()) continue;
    sum += world.reactions()[o].force;
  }
  return sum;
}

void run_until(World& world, double time) {
  while (world.time() < time - 1e-9) world.step();
}

// The times are those of config/robots/demo_motion.yaml.
TEST(DemoScene, TheFingersFeelTheRabbitsWeightAndItDoesNotSlip) {
  const auto world = rabbit_alone();
  const Eigen::Vector3d start = center_of(*world);
  const double weight = 9.81 * rabbit_of(*world).mass.sum();
  run_until(*world, 3.7);
  const Eigen::Vector3d held = center_of(*world);
  EXPECT_GT(held.z(), start.z() + 0.1);
  Eigen::Vector3d felt = Eigen::Vector3d::Zero();
  constexpr int kSteps = 100;
  for (int k = 0; k < kSteps; ++k) {
    world->step();
    felt += force_on(*world, "_finger") / kSteps;
  }
  EXPECT_NEAR(-felt.z() / weight, 1.0, 0.01);
  EXPECT_LT(felt.head<2>().norm(), 0.01 * weight);
  const double slip = (center_of(*world) - held).norm() / (kSteps * world->time_step());
  EXPECT_LT(slip, 1e-4);
  // Each finger squeezes with several times the weight.
  EXPECT_GT(force_on(*world, "left_finger").y(), 2.0 * weight);
  EXPECT_LT(force_on(*world, "right_finger").y(), -2.0 * weight);

  run_until(*world, 7.0);
  EXPECT_EQ(force_on(*world, "_finger").norm(), 0.0);
  const Eigen::Vector3d laid_down = center_of(*world);
  EXPECT_LT((laid_down.head<2>() - Eigen::Vector2d(0.534, -0.100)).norm(), 0.01);
  run_until(*world, 7.3);
  EXPECT_LT((center_of(*world) - laid_down).norm(), 1e-4);
}

}  // namespace
}  // namespace pliant::demo_scene_test
