// A gripper that holds cloth by friction alone pulls it through a ring, and a shirt off a
// mannequin.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "pliant/scene/scene.h"
#include "support/meshes/passes.h"

namespace pliant::pulled_cloth_test {
namespace {

// Of the scene: where the ring is, the circle along its capsules and their radius [m].
constexpr double kRingHeight = 0.16, kRingRadius = 0.06, kTube = 0.008;
constexpr double kEnd = 3.6;  // of the pull [s]
// The height of the mannequin's hands [m], and when the shirt is off [s].
constexpr double kHands = 0.278, kOff = 3.6;

/// A scene with other words in place of some of it: fewer vertices.
SceneSpec coarse_scene(const std::string& name, const std::string& fine,
                       const std::string& coarse) {
  const std::string path = std::string(PLIANT_SOURCE_DIR) + "/config/scenes/" + name + ".yaml";
  std::ifstream file(path);
  std::stringstream stream;
  stream << file.rdbuf();
  std::string text = stream.str();
  const std::size_t place = text.find(fine);
  if (place == std::string::npos) throw std::runtime_error(name + " has no " + fine);
  text.replace(place, fine.size(), coarse);
  return read_scene(path, nullptr, {}, &text);
}

/// Vertices stay a millimetre off what they touch, and what fingers press from both sides too.
void expect_nothing_inside(const World& world) {
  const Positions& x = world.bodies().front().particles().x;
  for (const Obstacle& obstacle : world.obstacles()) {
    const Eigen::Isometry3d local = obstacle.pose_end.inverse();
    double depth = 0.0;
    for (const auto p : x.colwise()) {
      depth = std::max(depth, -obstacle.shape->query(local * p).distance);
    }
    ASSERT_LT(depth, 1e-4) << obstacle.name << world.time();
  }
}

TEST(PulledCloth, FrictionAloneTakesItThroughARing) {
  const auto world = build_world(
      coarse_scene("cloth_pulled_through_ring", "vertices: [42, 62]", "vertices: [21, 31]"));
  const Body& cloth = world->bodies().front();
  EXPECT_EQ(cloth.find_effect("attachment"), nullptr) << "nothing but friction holds it";
  const Positions& x = cloth.particles().x;
  ASSERT_LT(x.row(2).maxCoeff(), kRingHeight - kTube) << "it begins below the ring";
  double widest = 0.0;
  while (world->time() < kEnd) {
    const Positions before = x;
    ASSERT_TRUE(world->step()) << world->failure();
    expect_nothing_inside(*world);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      if ((before(2, i) < kRingHeight) == (x(2, i) < kRingHeight)) continue;
      widest = std::max(widest, x.col(i).head<2>().norm());
    }
    if (world->steps() % 20 == 0) {
      ASSERT_EQ(find_passes(*world).size(), 0u) << world->time();
    }
  }
  EXPECT_GT(x.row(2).minCoeff(), kRingHeight + kTube) << "all of it is above the ring";
  EXPECT_LT(widest, kRingRadius) << "and came through it";
}

TEST(PulledCloth, FrictionAloneTakesAShirtOffAMannequin) {
  const auto world = build_world(coarse_scene("shirt_pulled_off", "shirt.obj", "shirt_coarse.obj"));
  const Body& shirt = world->bodies().front();
  EXPECT_EQ(shirt.find_effect("attachment"), nullptr) << "nothing but friction holds it";
  const Positions& x = shirt.particles().x;
  ASSERT_LT(x.row(2).maxCoeff(), kHands) << "it is worn: its cuffs are below the hands";
  while (world->time() < kOff) {
    ASSERT_TRUE(world->step()) << world->failure();
    expect_nothing_inside(*world);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
    if (world->steps() % 20 == 0) {
      ASSERT_EQ(find_passes(*world).size(), 0u) << world->time();
    }
  }
  EXPECT_GT(x.row(2).minCoeff(), kHands) << "all of it is above the hands";
}

}  // namespace
}  // namespace pliant::pulled_cloth_test
