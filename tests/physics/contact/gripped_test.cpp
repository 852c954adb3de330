// Grippers whose joints stall: they close as far as they can, press with the effort of their
// joints, and hold what they grip, rigid or soft.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"
#include "support/worlds/worlds.h"
#include "unit/scene/scene_files.h"

namespace pliant::gripped_test {
namespace {

constexpr double kGravity = 9.81;
const std::string kConfig = std::string(PLIANT_SOURCE_DIR) + "/config";

/// The gripper comes down about what stands at the origin, closes as far as it can, and lifts it by
/// 8 cm.
constexpr const char* kMotion =
    "joints: [gantry_x, gantry_y, gantry_z, wrist, left_finger_joint, right_finger_joint]\n"
    "interpolation: cubic\n"
    "keyframes:\n"
    "  - {time: 0.0, positions: [0, 0, 0.01, 0, 0.04, 0.04]}\n"
    "  - {time: 0.1, positions: [0, 0, 0.01, 0, 0.04, 0.04]}\n"
    "  - {time: 0.5, positions: [0, 0, 0.01, 0, 0.0, 0.0]}\n"
    "  - {time: 0.7, positions: [0, 0, 0.01, 0, 0.0, 0.0]}\n"
    "  - {time: 1.3, positions: [0, 0, 0.09, 0, 0.0, 0.0]}\n";

/// It lifts it by 3 cm and carries it there and back, by 15 cm in a quarter of a second each time.
std::string carried_along(char axis) {
  const std::string there = axis == 'x' ? "0.15, 0" : "0, 0.15";
  return fmt::format(
      "joints: [gantry_x, gantry_y, gantry_z, wrist, left_finger_joint, right_finger_joint]\n"
      "interpolation: cubic\nkeyframes:\n"
      "  - {{time: 0.0, positions: [0, 0, 0.01, 0, 0.04, 0.04]}}\n"
      "  - {{time: 0.1, positions: [0, 0, 0.01, 0, 0.04, 0.04]}}\n"
      "  - {{time: 0.5, positions: [0, 0, 0.01, 0, 0.0, 0.0]}}\n"
      "  - {{time: 0.6, positions: [0, 0, 0.01, 0, 0.0, 0.0]}}\n"
      "  - {{time: 0.9, positions: [0, 0, 0.04, 0, 0.0, 0.0]}}\n"
      "  - {{time: 1.15, positions: [{}, 0.04, 0, 0.0, 0.0]}}\n"
      "  - {{time: 1.4, positions: [0, 0, 0.04, 0, 0.0, 0.0]}}\n",
      there);
}

struct Grip {
  std::string body, effort = "effort: limit", more, motion = kMotion;
};

std::string scene_of(const Grip& grip) {
  return fmt::format(
      "time_step: 0.01\nbodies:\n  - {{name: body, {}}}\n"
      "obstacles: [{{name: table, shape: box, size: [0.4, 0.4, 0.02], position: [0, 0, -0.01]}}]\n"
      "robot: {{urdf: {}/robots/gripper.urdf, keyframes: motion.yaml, friction: 1.0, {}}}\n"
      "effects:\n  gravity: {{acceleration: [0, 0, -9.81]}}\n  contact: {{thickness: 0.002}}\n"
      "  friction: {{coefficient: 0.6}}\n{}",
      grip.body, kConfig, grip.effort, grip.more);
}

/// A scene that runs for 1.6 s.
class Gripped {
 public:
  explicit Gripped(const Grip& grip) {
    files_.write("motion.yaml", grip.motion);
    scene_ = load_scene(files_.write("scene.yaml", scene_of(grip)));
    start_ = middle();
    weight_ = kGravity * body().particles().mass.sum();
  }
  /// What the left and the right finger feel in the last 0.2 s [N], and what they lift.
  void run() {
    for (int k = 0; k < 160; ++k) {
      ASSERT_TRUE(scene_.world->step()) << scene_.world->failure();
      if (k < 140) continue;
      for (std::size_t o = 0; o < scene_.world->obstacles().size(); ++o) {
        const Eigen::Vector3d& force = scene_.world->reactions()[o].force;
        const std::string& link = scene_.world->obstacles()[o].link;
        if (link == "left_finger") left_ += force.x() / 20.0;
        if (link == "right_finger") right_ -= force.x() / 20.0;
        if (!link.empty()) lifted_ -= force.z() / 20.0;
      }
      for (const std::string& warning : body().report.warnings) warnings_ += warning + "\n";
    }
  }
  const Body& body() const { return scene_.world->bodies().front(); }
  Eigen::Vector3d middle() const {
    const Particles& p = body().particles();
    return (p.x * p.mass) / p.mass.sum();
  }
  Eigen::Vector3d moved() const { return middle() - start_; }
  double left() const { return left_; }
  double right() const { return right_; }
  double lifted() const { return lifted_; }
  double weight() const { return weight_; }
  const std::string& warnings() const { return warnings_; }

 private:
  SceneFiles files_;
  LoadedScene scene_;
  Eigen::Vector3d start_;
  double left_ = 0.0, right_ = 0.0, lifted_ = 0.0, weight_ = 0.0;
  std::string warnings_;
};

// By default, larger and smaller, light and heavy: none is thrown out, slips or turns.
class GrippedRigid : public testing::TestWithParam<std::string> {};

std::string rigid(const std::string& geometry, double z, const std::string& more = "") {
  return fmt::format("model: rigid, geometry: {{{}}}, position: [0, 0, {}], {}", geometry, z,
                     more.empty() ? "material: {density: 300}" : more);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, GrippedRigid,
    testing::Values(rigid("box: {size: [0.066, 0.066, 0.066]}", 0.034),
                    rigid("box: {size: [0.02, 0.05, 0.05]}", 0.026),
                    rigid("box: {size: [0.06, 0.04, 0.07]}", 0.036, "material: {density: 3000}"),
                    rigid("box: {size: [0.05, 0.05, 0.05]}", 0.026, "rotation_rpy: [0, 0, 0.02]"),
                    rigid("sphere: {radius: 0.035}", 0.036),
                    rigid("cylinder: {radius: 0.03, length: 0.08}", 0.041),
                    rigid("capsule: {radius: 0.025, length: 0.02}", 0.036),
                    rigid("mesh: " + kConfig + "/meshes/mug.obj, scale: 0.75", 0.001,
                          "rotation_rpy: [0, 0, 1.5708]")),
    [](const auto& info) { return "number_" + std::to_string(info.index); });

TEST_P(GrippedRigid, IsLifted) {
  Gripped gripped({GetParam()});
  gripped.run();
  EXPECT_NEAR(gripped.moved().z(), 0.08, 5e-4);
  EXPECT_LT(gripped.body().particles().v.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_NEAR(gripped.lifted(), gripped.weight(), 0.01 * gripped.weight());
  EXPECT_NEAR(gripped.left(), gripped.right(), 0.01 * gripped.left());
  EXPECT_EQ(gripped.warnings(), "");
}

// Solvers whose forces grow until nothing is left to press reach the effort of the joints.
class GrippedBy : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Solvers, GrippedBy, testing::Values("newton", "gauss_seidel", "jacobi"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(GrippedBy, TheEffortOfItsJoints) {
  Gripped gripped({rigid("box: {size: [0.05, 0.05, 0.05]}", 0.026),
                   "efforts: {left_finger_joint: 12, right_finger_joint: 12}",
                   fmt::format("solver: {{name: {}}}\n", GetParam())});
  gripped.run();
  EXPECT_NEAR(gripped.left(), 12.0, 0.02 * 12.0);
  EXPECT_NEAR(gripped.right(), 12.0, 0.02 * 12.0);
  EXPECT_NEAR(gripped.moved().z(), 0.08, 5e-4);
}

// Boxes of 1, 5 and 20 g: light bodies gave way until fingers had no room, and stopped them at 0.8,
// 4.2 and 17 N.
TEST(GrippedLight, PressesWithTheEffort) {
  for (const double mass : {0.001, 0.005, 0.02}) {
    for (const char* name : {"", "newton", "jacobi", "gauss_seidel", "hybrid", "chebyshev"}) {
      const std::string more = fmt::format("material: {{mass: {}}}", mass);
      Gripped gripped({rigid("box: {size: [0.05, 0.05, 0.05]}", 0.0255, more),
                       "efforts: {left_finger_joint: 40, right_finger_joint: 40}",
                       *name == 0 ? "" : fmt::format("solver: {{name: {}}}\n", name)});
      gripped.run();
      EXPECT_NEAR(gripped.left(), 40.0, 0.01 * 40.0) << mass << name;
      EXPECT_NEAR(gripped.left(), gripped.right(), 1e-3 * 40.0) << mass << name;
      EXPECT_NEAR(gripped.lifted(), gripped.weight(), 0.01 * gripped.weight()) << mass << name;
      EXPECT_NEAR(gripped.moved().z(), 0.08, 6e-4) << mass << name;
    }
  }
}

// Bodies that give way press as hard as the joints, whatever their stiffness.
class GrippedSoft : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Stiffnesses, GrippedSoft, testing::Values(3e4, 1e5, 1e6, 1e7),
                         [](const auto& info) { return "at" + std::to_string(info.index); });

TEST_P(GrippedSoft, PressesWithTheEffort) {
  constexpr double kEffort = 2.0;
  Gripped gripped(
      {fmt::format("model: patch, geometry: {{block: {{size: [0.05, 0.05, 0.06], cells: "
                   "[4, 4, 4]}}}}, position: [0, 0, 0.031], material: {{young: {}, "
                   "poisson: 0.3, density: 300}}",
                   GetParam()),
       "efforts: {left_finger_joint: 2, right_finger_joint: 2}"});
  gripped.run();
  EXPECT_NEAR(gripped.left(), kEffort, 0.03 * kEffort);
  EXPECT_NEAR(gripped.right(), kEffort, 0.03 * kEffort);
  EXPECT_NEAR(gripped.lifted(), gripped.weight(), 0.03 * gripped.weight());
  EXPECT_NEAR(gripped.moved().z(), 0.08, 3e-4);
}

std::string block_of(const std::string& young, double turned) {
  return fmt::format(
      "model: patch, geometry: {{block: {{size: [0.05, 0.05, 0.06], cells: [4, 4, 4]}}}}, "
      "position: [0, 0, 0.031], rotation_rpy: [0, 0, {}], material: {{young: {}, poisson: 0.3, "
      "density: 400}}",
      turned, young);
}
constexpr const char* kEightNewtons = "efforts: {left_finger_joint: 8, right_finger_joint: 8}";

// They fell out: the friction that keeps them from turning was forgotten in each step in which the
// hand accelerated.
TEST(Gripped, StiffBlocksByTwoOfTheirEdges) {
  for (const char* young : {"1e6", "1e7", "1e8"}) {
    Gripped gripped({block_of(young, 0.3), kEightNewtons});
    gripped.run();
    EXPECT_NEAR(gripped.moved().z(), 0.08, 3e-4) << young;
    EXPECT_NEAR(gripped.left(), 8.0, 0.03 * 8.0) << young;
  }
}

TEST(Gripped, AStiffBlockIsCarriedAlongAndAcrossItsFingers) {
  for (const char axis : {'x', 'y'}) {
    // Along them at 14 m/s² one is lost that is held by its edges: it falls (at 5 ms it does not).
    for (const double turned : axis == 'x' ? std::vector{0.0} : std::vector{0.0, 0.3}) {
      Gripped gripped({block_of("1e7", turned), kEightNewtons, "", carried_along(axis)});
      gripped.run();
      const Eigen::Vector3d slip = gripped.moved() - Eigen::Vector3d(0, 0, 0.03);
      EXPECT_LT(slip.tail<2>().norm(), 3e-4) << axis << " " << turned << " " << slip.transpose();
      // Both joints press with the same effort wherever they are: that is no slip.
      EXPECT_LT(std::abs(slip.x()), 1e-3) << axis << " " << turned << " " << slip.transpose();
    }
  }
}

// A joint that cannot carry a body does not lift it: 10 N of effort against some 20 N.
TEST(Gripped, WhatIsTooHeavyStays) {
  Gripped gripped({rigid("box: {size: [0.06, 0.06, 0.066]}", 0.034, "material: {density: 8600}"),
                   "efforts: {gantry_z: 10, left_finger_joint: 60, right_finger_joint: 60}"});
  gripped.run();
  EXPECT_GT(gripped.weight(), 19.0);
  EXPECT_LT(gripped.moved().z(), 1e-3);
  EXPECT_NEAR(gripped.lifted(), 10.0, 1.0);
}

}  // namespace
}  // namespace pliant::gripped_test
