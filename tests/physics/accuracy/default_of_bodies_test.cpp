// Scenes that name no solver: cloth, a solid and a rigid body that touch and slide, rigid bodies in
// a stack and one alone, a ball in a gripper. Where they come to is within 5 % of what converged
// steps give, and nothing says otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "pliant/models/solver_registry.h"
#include "support/measures.h"
#include "support/rms_distance.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::default_of_bodies_test {
namespace {

constexpr const char* kEffects =
    "  gravity: {}\n  damping: {rate: 1}\n  contact: {thickness: 0.002}\n"
    "  friction: {coefficient: 0.5}\n  body_contact: {thickness: 0.002, friction: 0.4}\n";
constexpr const char* kConverged =
    "solver: {name: newton, iterations: 30, tolerance: 1.0e-3, linear_tolerance: 1.0e-3}\n";

/// A block on a table, on it a box that slides, and over both a strip of cloth that falls; turned
/// by `yaw` about the vertical.
std::unique_ptr<World> pile(const std::string& young, double yaw, const std::string& solver) {
  const Eigen::Vector3d velocity =
      Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(0.3, 0.0, 0.0);
  const std::string block = fmt::format(
      "  - {{name: block, model: patch, geometry: {{block: {{size: [0.12, 0.1, 0.04], cells: [5, "
      "4, 2]}}}}, material: {{young: {}, density: 500}}, position: [0, 0, 0.0225], rotation_rpy: "
      "[0, 0, {}]}}\n",
      young, yaw);
  const std::string box = fmt::format(
      "  - {{name: box, model: rigid, geometry: {{box: {{size: [0.05, 0.04, 0.03]}}}}, material: "
      "{{density: 800}}, position: [0, 0, 0.06], rotation_rpy: [0, 0, {}], velocity: [{}, {}, "
      "0]}}\n",
      yaw + 0.4, velocity.x(), velocity.y());
  const std::string cloth = fmt::format(
      "  - {{name: cloth, model: cloth, geometry: {{grid: {{size: [0.26, 0.1], vertices: [21, "
      "9]}}}}, material: {{areal_density: 0.15, stretch_warp: 300, stretch_weft: 300, shear: 30, "
      "bending: 2.0e-5}}, position: [0, 0, 0.085], rotation_rpy: [0, 0, {}]}}\n",
      yaw);
  return world_of(scene_text({block, box, cloth}, kEffects,
                             "obstacles: [{name: table, shape: plane}]\n" + solver));
}

class DefaultOfBodies : public testing::TestWithParam<std::pair<const char*, double>> {};
INSTANTIATE_TEST_SUITE_P(Piles, DefaultOfBodies,
                         testing::Values(std::pair("1.0e+4", 0.0), std::pair("1.0e+5", 0.7),
                                         std::pair("1.0e+6", 2.0), std::pair("1.0e+8", 0.7)));

TEST_P(DefaultOfBodies, IsWithinFivePerCentWithoutAWarning) {
  const auto& [young, yaw] = GetParam();
  const auto world = pile(young, yaw, ""), exact = pile(young, yaw, kConverged);
  std::vector<Positions> first;
  for (const Body& body : exact->bodies()) first.push_back(body.particles().x);
  for (int k = 1; k <= 50; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_TRUE(exact->step()) << exact->failure();
    EXPECT_FALSE(warns(*world, "inaccurate")) << k;
    if (k % 10 != 0) continue;
    for (std::size_t b = 0; b < first.size(); ++b) {
      const Body& body = world->bodies()[b];
      const Particles& p = exact->bodies()[b].particles();
      EXPECT_EQ(body.solver->name(), "newton");
      const Eigen::Vector3d center = first[b] * p.mass / p.mass.sum();
      const double size = rms_distance(p, first[b], center.replicate(1, p.size()));
      const double travel = std::max(rms_distance(p, p.x, first[b]), 0.01 * size);
      const double error = rms_distance(p, body.particles().x, p.x) / travel;
      EXPECT_LE(error, 0.05) << body.name << " after " << k;
    }
  }
}

constexpr const char* kExact = "solver: {name: newton, iterations: 100, tolerance: 1.0e-7}\n";

/// Three boxes one on another, each a little to a side, the uppermost ten times as dense.
std::unique_ptr<World> stack(const std::string& solver) {
  std::vector<std::string> boxes;
  for (int k = 0; k < 3; ++k) {
    boxes.push_back(fmt::format(
        "  - {{name: box{}, model: rigid, geometry: {{box: {{size: [0.06, 0.06, 0.06]}}}}, "
        "position: [{}, {}, {}], material: {{density: {}}}}}\n",
        k, k == 1 ? 0.005 : 0.0, k == 2 ? 0.005 : 0.0, 0.0315 + 0.0615 * k, k == 2 ? 5000 : 500));
  }
  return world_of(scene_text(boxes,
                             "  gravity: {}\n  contact: {thickness: 0.001}\n  friction: "
                             "{coefficient: 0.8}\n  body_contact: {thickness: 0.001}\n",
                             "obstacles: [{name: table, shape: plane}]\n" + solver));
}

TEST(DefaultOfRigidBodies, AHeavyBoxOnLightOnesIsWithinFivePerCentWithoutAWarning) {
  const auto world = stack(""), exact = stack(kExact);
  std::vector<Positions> first;
  for (const Body& body : exact->bodies()) first.push_back(body.particles().x);
  for (int k = 1; k <= 300; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_TRUE(exact->step()) << exact->failure();
    EXPECT_FALSE(warns(*world, "inaccurate")) << k;
  }
  for (std::size_t b = 0; b < first.size(); ++b) {
    const Particles& p = exact->bodies()[b].particles();
    const double travel = rms_distance(p, p.x, first[b]);
    EXPECT_LE(rms_distance(p, world->bodies()[b].particles().x, p.x), 0.05 * travel) << b;
  }
}

/// A rigid body over a table that is tilted by `slope`.
std::unique_ptr<World> one(const std::string& body, double slope, double time_step,
                           const std::string& solver) {
  return world_of(fmt::format(
      "time_step: {}\n{}bodies:\n  - {{name: body, model: rigid, material: {{density: 600}}, "
      "{}}}\nobstacles: [{{name: table, shape: plane, friction: 0.5}}]\n"
      "effects:\n  gravity: {{acceleration: [{}, 0, {}]}}\n  contact: {{}}\n  friction: {{}}\n",
      time_step, solver, body, 9.81 * std::sin(slope), -9.81 * std::cos(slope)));
}

// Fifty sweeps, which larger heaps take, are up to 46 % off of the can.
TEST(DefaultOfRigidBodies, OneThatFallsRollsOrTumblesIsWithinFivePerCentWithoutAWarning) {
  const std::string tilted =
      ", position: [0, 0, 0.3], rotation_rpy: [0.3, 0.5, 0], velocity: "
      "[0.2, 0.1, 0]";
  const std::vector<std::pair<std::string, double>> scenes = {
      {"geometry: {cylinder: {radius: 0.03, length: 0.08}}" + tilted, 0.0},
      {"geometry: {box: {size: [0.06, 0.05, 0.04]}}" + tilted, 0.0},
      {"geometry: {sphere: {radius: 0.03}}, position: [0, 0, 0.1]", 0.64}};
  for (const auto& [body, slope] : scenes) {
    for (const double time_step : {0.005, 0.01}) {
      const auto world = one(body, slope, time_step, "");
      const auto exact = one(body, slope, time_step, kExact);
      const Positions first = body_of(*world).particles().x;
      while (world->time() < 0.8) {
        ASSERT_TRUE(world->step()) << world->failure();
        ASSERT_TRUE(exact->step()) << exact->failure();
        EXPECT_FALSE(warns(*world, "inaccurate")) << body << " " << world->time();
      }
      const Particles& p = body_of(*exact).particles();
      EXPECT_LE(rms_distance(p, body_of(*world).particles().x, p.x),
                0.05 * rms_distance(p, p.x, first))
          << body << " at " << time_step << " s";
    }
  }
}

/// A square of cloth that swings down from two of its corners.
std::unique_ptr<World> hanging(double stretch, const std::string& more) {
  return world_of(fmt::format(
      "time_step: 0.005\nbodies:\n  - {{name: cloth, model: cloth, geometry: {{grid: {{size: [0.5, "
      "0.5], vertices: [21, 21]}}}}, material: {{areal_density: 0.2, stretch_warp: {0}, "
      "stretch_weft: {0}, shear: {1}, bending: 1.0e-5}}, fixed: [{{vertices: [0, 20]}}]}}\n"
      "effects:\n  gravity: {{}}\n{2}",
      stretch, 0.1 * stretch, more));
}

/// The same in front of a ball that it swings against.
std::unique_ptr<World> hanging_at_ball(double stretch, const std::string& solver) {
  return hanging(stretch,
                 "  contact: {}\n  friction: {coefficient: 0.4}\n  self_contact: {}\n"
                 "obstacles: [{name: ball, shape: sphere, radius: 0.08, position: [0, 0.1, "
                 "-0.25]}]\n" +
                     solver);
}

// Sweeps, which other cloth takes, are up to 12 % off where it is stiff. Later the stiff one
// buckles, where any difference grows.
TEST(DefaultOfACloth, ThatHangsIsWithinFivePerCentWithoutAWarning) {
  for (const double stretch : {10.0, 1e3, 1e5}) {
    const auto world = hanging(stretch, "");
    const auto exact = hanging(stretch, "solver: {name: newton, tolerance: 1.0e-6}\n");
    const Positions first = particles_of(*world).x;
    for (int k = 1; k <= 50; ++k) {
      ASSERT_TRUE(world->step()) << world->failure();
      ASSERT_TRUE(exact->step()) << exact->failure();
      EXPECT_FALSE(warns(*world, "inaccurate")) << stretch << " " << k;
    }
    const Particles& p = particles_of(*exact);
    EXPECT_LE(rms_distance(p, particles_of(*world).x, p.x), 0.05 * rms_distance(p, p.x, first))
        << stretch;
  }
}

// Sweeps are told to be up to 50 % off here, at two to five times the time. Converged steps were
// told to be up to 22 % off, and were, where the final projection alone answered what iterations
// moved into the ball.
TEST(DefaultOfACloth, ThatHangsBesideAnObstacleIsWithinFivePerCentWithoutAWarning) {
  for (const double stretch : {100.0, 1e3, 1e4}) {
    const auto world = hanging_at_ball(stretch, "");
    const auto exact = hanging_at_ball(stretch, "solver: {name: newton, tolerance: 1.0e-5}\n");
    const Positions first = particles_of(*world).x;
    bool touches = false;
    for (int k = 1; k <= 80; ++k) {
      ASSERT_TRUE(world->step()) << world->failure();
      ASSERT_TRUE(exact->step()) << exact->failure();
      touches = touches || world->bodies().front().report.contacts > 0;
      EXPECT_FALSE(warns(*world, "inaccurate")) << stretch << " " << k;
    }
    EXPECT_TRUE(touches);
    const Particles& p = particles_of(*exact);
    EXPECT_LE(rms_distance(p, particles_of(*world).x, p.x), 0.05 * rms_distance(p, p.x, first))
        << stretch;
  }
}

// Where nothing happens for a while one iteration a step is enough, and when the gripper closes
// that has to be over at once: iterations that are chosen from estimates now and then come too
// late.
TEST(DefaultOfASolid, CarriesAGrippedBallWithinFivePerCentWithoutAWarning) {
  const std::string file = std::string(PLIANT_SOURCE_DIR) + "/config/scenes/demo_patch.yaml";
  const LoadedScene scene = load_scene(file), exact = load_scene(file);
  Body& ball = scene.world->bodies().front();
  Body& exact_ball = exact.world->bodies().front();
  const DefaultSolver& solver = default_solver("patch");
  scene.world->set_solver(ball, all_solvers(), solver.name, solver.parameters, "test");
  exact.world->set_solver(exact_ball, all_solvers(), "lbfgs",
                          {{"tolerance", "1e-3"}, {"iterations", "100"}}, "test");
  const Positions first = ball.particles().x;
  double told = 0.0;
  for (int k = 1; k <= 320; ++k) {
    ASSERT_TRUE(scene.world->step()) << scene.world->failure();
    ASSERT_TRUE(exact.world->step()) << exact.world->failure();
    told = std::max(told, ball.report.error.value_or(1.0));
  }
  EXPECT_LE(told, 0.05);
  const Particles& p = exact_ball.particles();
  const double travel = rms_distance(p, p.x, first);
  EXPECT_GT(travel, 0.02) << "lifted";
  EXPECT_LE(rms_distance(p, ball.particles().x, p.x), 0.05 * travel);
}

}  // namespace
}  // namespace pliant::default_of_bodies_test
