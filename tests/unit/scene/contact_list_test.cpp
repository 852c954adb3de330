#include "pliant/scene/contact_list.h"

#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

constexpr const char* kHeap = R"(
time_step: 0.005
threads: 1
gravity: [0, 0, -9.81]
bodies:
  - name: towel
    model: cloth
    geometry: {grid: {size: [0.12, 0.12], vertices: [9, 9]}}
    position: [0, 0, 0.085]
    material: {areal_density: 0.2, stretch_warp: 100, stretch_weft: 100, shear: 10}
  - name: ball
    model: patch
    geometry: {sphere: {radius: 0.04}, tetrahedra: 100, surface_level: 2}
    position: [0, 0, 0.042]
    material: {young: 2.0e+4, poisson: 0.3, density: 300}
obstacles:
  - {name: table, shape: plane}
effects:
  damping: {rate: 2.0}
  contact: {thickness: 0.002}
  friction: {coefficient: 0.5}
  body_contact: {thickness: 0.002, friction: 0.4}
solver: {name: xpbd, iterations: 20}
)";

constexpr const char* kPool = R"(
time_step: 0.004
threads: 1
gravity: [0, 0, -9.81]
bodies:
  - name: water
    model: viscoelastic
    geometry: {block: {size: [0.04, 0.04, 0.04]}, spacing: 0.01}
    position: [0, 0, 0.021]
    material: {state: liquid}
obstacles:
  - {name: floor, shape: plane}
effects:
  contact: {thickness: 0.004}
)";

class ContactListTest : public ::testing::Test {
 protected:
  ~ContactListTest() override { set_threads(1); }
  World& run(const char* text, int steps) {
    scene_ = load_scene(files_.write("scene.yaml", text));
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(scene_.world->step());
    list_contacts(*scene_.world, touched_);
    return *scene_.world;
  }
  /// What obstacles do to bodies, by the list.
  Eigen::Vector3d from_obstacles() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const TouchedPoint& touch : touched_) {
      if (touch.obstacle >= 0) sum += touch.force;
    }
    return sum;
  }

  SceneFiles files_;
  LoadedScene scene_;
  std::vector<TouchedPoint> touched_;
};

TEST_F(ContactListTest, ForcesSumToTheReactions) {
  World& world = run(kHeap, 100);
  int with_table = 0, with_ball = 0;
  for (const TouchedPoint& touch : touched_) {
    EXPECT_NEAR(touch.normal.norm(), 1.0, 1e-9);
    const Body& body = world.bodies()[static_cast<std::size_t>(touch.body)];
    ASSERT_LT(touch.vertex, body.particles().size());
    // The vertices that carry a point of the ball are the corners of a tetrahedron of it.
    EXPECT_LT((touch.point - body.particles().x.col(touch.vertex)).norm(), 0.04);
    if (touch.obstacle >= 0) {
      ++with_table;
      EXPECT_EQ(touch.other_body, -1);
      EXPECT_GT(touch.force.z(), 0.0);
    } else {
      ++with_ball;
      EXPECT_NE(touch.other_body, touch.body);
      EXPECT_NEAR(touch.point.z(), 0.08, 0.02);
    }
  }
  EXPECT_GT(with_table, 0);
  EXPECT_GT(with_ball, 3);
  EXPECT_LT((from_obstacles() + world.reactions()[0].force).norm(), 1e-9);
  EXPECT_GT(from_obstacles().z(), 0.1);
}

TEST_F(ContactListTest, ForcesBetweenBodiesChangeTheMomentumOfTheUpperOne) {
  constexpr int kSteps = 100;
  World& world = run(kHeap, 200);
  const Particles& towel = world.bodies()[0].particles();
  const auto momentum = [&] { return Eigen::Vector3d(towel.v * towel.mass); };
  const Eigen::Vector3d start = momentum();
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero();
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world.step());
    list_contacts(world, touched_);
    for (const TouchedPoint& touch : touched_) {
      if (touch.body == 0) impulse += world.time_step() * touch.force;
      if (touch.other_body == 0) impulse -= world.time_step() * touch.force;
    }
  }
  const double weight = 9.81 * towel.mass.sum() * kSteps * world.time_step();
  const double gained = (momentum() - start).z();
  // Damping takes a little of what moves.
  EXPECT_NEAR(impulse.z(), weight + gained, 0.05 * weight);
}

TEST_F(ContactListTest, WallsPushALiquid) {
  World& world = run(kPool, 40);
  EXPECT_GT(touched_.size(), 10u);
  for (const TouchedPoint& touch : touched_) {
    EXPECT_EQ(touch.obstacle, 0);
    EXPECT_NEAR(touch.normal.z(), 1.0, 1e-9);
  }
  // The list has the last substep alone.
  const double reaction = -world.reactions()[0].force.z();
  EXPECT_GT(from_obstacles().z(), 0.3 * reaction);
  EXPECT_LT(from_obstacles().z(), 3.0 * reaction);
}

TEST_F(ContactListTest, NothingIsListedOfWhatTouchesNothing) {
  run(kHeap, 0);
  EXPECT_TRUE(touched_.empty());
  touched_.resize(3);
  run(kHeap, 1);
  for (const TouchedPoint& touch : touched_) EXPECT_GT(touch.force.norm(), 0.0);
}

}  // namespace
}  // namespace pliant
