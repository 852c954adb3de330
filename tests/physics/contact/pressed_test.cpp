// Bodies that a plate presses onto a table, and that a turntable takes along, whatever
// the length of the time step.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "pliant/scene/scene.h"
#include "unit/scene/scene_files.h"

namespace pliant::pressed_test {
namespace {

constexpr double kGravity = 9.81;
const std::string kRobots = std::string(PLIANT_SOURCE_DIR) + "/config/robots";

struct Material {
  const char* name;
  std::string body;
  double press;             // m
  std::string solver = "";  // the default
};

std::string block_of(const char* young) {
  return fmt::format(
      "model: patch, geometry: {{block: {{size: [0.06, 0.06, 0.06], cells: [3, 3, 3]}}}}, "
      "material: {{young: {}, poisson: 0.3, density: 500}}",
      young);
}

std::string balls_of(const char* young) {
  return fmt::format(
      "model: viscoelastic, geometry: {{block: {{size: [0.06, 0.06, 0.06]}}, particles: 400}}, "
      "material: {{state: elastic, young: {}, density: 500}}",
      young);
}

std::string scene_of(const std::string& body, double time_step, const std::string& robot,
                     const std::string& more) {
  return fmt::format(
      "time_step: {}\nbodies:\n  - {{name: block, {}}}\n{}robot: {}\n"
      "effects:\n  gravity: {{acceleration: [0, 0, -{}]}}\n  contact: {{thickness: 0.001}}\n"
      "  friction: {{coefficient: 0.5}}\n",
      time_step, body, more, robot, kGravity);
}

/// Forces on the plate and on the table at the end [N].
struct Forces {
  double plate = 0.0, table = 0.0;
};

/// The plate goes down to the block of 6 cm and `press` farther, and waits.
Forces forces_of(const Material& material, double time_step) {
  const SceneFiles files;
  files.write("motion.yaml", fmt::format("joints: [plate_joint]\ninterpolation: cubic\nkeyframes:\n"
                                         "  - {{time: 0.0, positions: [0.065]}}\n"
                                         "  - {{time: 0.1, positions: [0.065]}}\n"
                                         "  - {{time: 0.5, positions: [{}]}}\n",
                                         0.061 - material.press));
  const LoadedScene scene = load_scene(files.write(
      "scene.yaml",
      scene_of(
          material.body + ", position: [0, 0, 0.031]", time_step,
          fmt::format("{{urdf: {}/press.urdf, keyframes: motion.yaml, friction: 0.5}}", kRobots),
          "obstacles: [{name: table, shape: plane}]\n" + material.solver)));
  World& world = *scene.world;
  const int steps = static_cast<int>(std::lround(1.0 / time_step));
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(world.step()) << world.failure();
  Forces forces;
  for (std::size_t o = 0; o < world.obstacles().size(); ++o) {
    const double along = world.reactions()[o].force.z();
    (world.obstacles()[o].link == "plate" ? forces.plate : forces.table) += along;
  }
  return forces;
}

class Pressed : public testing::TestWithParam<Material> {};

INSTANTIATE_TEST_SUITE_P(Materials, Pressed,
                         testing::Values(Material{"soft", block_of("1.0e+4"), 0.01},
                                         Material{"middle", block_of("1.0e+6"), 0.006},
                                         Material{"stiff", block_of("1.0e+8"), 0.001},
                                         Material{"balls", balls_of("1.0e+5"), 0.012}),
                         [](const auto& info) { return info.param.name; });

TEST_P(Pressed, PressesBackAsMuchInEveryTimeStep) {
  const double weight = 500 * std::pow(0.06, 3) * kGravity;
  const Forces at_rest = forces_of(GetParam(), 0.0025);
  EXPECT_GT(at_rest.plate, 2.0 * weight);
  for (const double time_step : {0.01, 0.008}) {
    const Forces forces = forces_of(GetParam(), time_step);
    EXPECT_NEAR(forces.plate, at_rest.plate, 2e-3 * at_rest.plate) << time_step;
    EXPECT_NEAR(-forces.table, forces.plate + weight, 2e-3 * forces.plate) << time_step;
  }
}

std::string iterated(const char* solver) {
  return fmt::format("solver: {{name: {}, iterations: 60}}\n", solver);
}

INSTANTIATE_TEST_SUITE_P(
    Solvers, Pressed,
    testing::Values(Material{"chebyshev", block_of("1.0e+5"), 0.006, iterated("chebyshev")},
                    Material{"gauss_seidel", block_of("1.0e+5"), 0.006, iterated("gauss_seidel")},
                    Material{"hybrid", block_of("1.0e+5"), 0.006, iterated("hybrid")},
                    Material{"lbfgs", block_of("1.0e+5"), 0.006, iterated("lbfgs")}),
    [](const auto& info) { return info.param.name; });

constexpr const char* kTurntable =
    "<robot name='turntable'><link name='base'/>"
    "<joint name='turn' type='continuous'><parent link='base'/><child link='disc'/>"
    "<axis xyz='0 0 1'/><limit velocity='20' effort='500'/></joint>"
    "<link name='disc'><inertial><mass value='3'/><inertia ixx='0.02' ixy='0' ixz='0' iyy='0.02' "
    "iyz='0' izz='0.03'/></inertial><collision><origin xyz='0 0 -0.01'/><geometry>"
    "<cylinder radius='0.25' length='0.02'/></geometry></collision></link></robot>";

/// By how much the block is ahead of the disc that it stands on, 12 cm from its middle, after the
/// disc has waited for it to land, come to 5 rad/s in a second and turned for half a second more
/// [rad].
double ahead_of_the_disc(double time_step) {
  const SceneFiles files;
  files.write("turntable.urdf", kTurntable);
  const auto angle = [](double t) {
    const double turning = std::max(0.0, t - 0.1);
    return turning < 1.0 ? 2.5 * turning * turning : 5.0 * turning - 2.5;
  };
  std::string motion = "joints: [turn]\ninterpolation: linear\nkeyframes:\n";
  for (int k = 0; k <= 200; ++k) {
    motion += fmt::format("  - {{time: {}, positions: [{:.9f}]}}\n", 0.01 * k, angle(0.01 * k));
  }
  files.write("motion.yaml", motion);
  const LoadedScene scene = load_scene(files.write(
      "scene.yaml", scene_of(block_of("1.0e+6") + ", position: [0.12, 0, 0.031]", time_step,
                             "{urdf: turntable.urdf, keyframes: motion.yaml, "
                             "friction: 0.5}",
                             "")));
  const int steps = static_cast<int>(std::lround(1.6 / time_step));
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(scene.world->step()) << scene.world->failure();
  const Particles& p = scene.world->bodies().front().particles();
  const Eigen::Vector3d middle =
      scene.world->obstacles().front().pose_end.inverse() * ((p.x * p.mass) / p.mass.sum());
  return std::atan2(middle.y(), middle.x());
}

// The disc pulls it with 61 % of what friction may hold, which shears it by micrometres.
TEST(Turntable, TakesABlockAlong) {
  for (const double time_step : {0.01, 0.005}) {
    EXPECT_LT(std::abs(ahead_of_the_disc(time_step)), 3e-5) << time_step;
  }
}

}  // namespace
}  // namespace pliant::pressed_test
