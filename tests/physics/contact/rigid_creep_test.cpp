// A rigid body that rests on a slope on which it sticks stays where it is, whatever its solver,
// shape and time step.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::rigid_creep_test {
namespace {

/// Geometry, half of its height [m].
using Shape = std::tuple<const char*, double>;
const Shape kBox{"box: {size: [0.06, 0.06, 0.06]}", 0.03};
const Shape kTall{"box: {size: [0.04, 0.04, 0.1]}", 0.05};
const Shape kCan{"cylinder: {radius: 0.03, length: 0.08}", 0.04};

/// On a slope of 18 degrees with a coefficient of friction of 0.5.
std::string scene_of(const Shape& shape, double time_step, const std::string& solver) {
  const auto& [geometry, half] = shape;
  return fmt::format(
      "time_step: {}\nbodies:\n  - {{name: body, model: rigid, geometry: {{{}}}, position: [0, 0, "
      "{}], material: {{density: 500}}}}\nobstacles: [{{name: floor, shape: plane}}]\neffects:\n"
      "  gravity: {{acceleration: [3.0, 0, -9.3]}}\n  contact: {{thickness: 0.002}}\n"
      "  friction: {{coefficient: 0.5}}\n{}",
      time_step, geometry, half + 0.001, solver);
}

/// How far the middle moves in half a second, once it has come to rest [m].
double creep(const std::string& scene) {
  const auto world = world_of(scene);
  run_for(*world, 0.3);
  const Particles& p = world->bodies().front().particles();
  const Eigen::Vector3d before = p.center_of_mass();
  run_for(*world, 0.5);
  return (p.center_of_mass() - before).norm();
}

// Their cluster bends by micrometres under their weight, by which they would creep in each step.
TEST(RigidBodies, DoNotCreepDownASlope) {
  for (const Shape& shape : {kBox, kTall, kCan}) {
    for (const double time_step : {0.002, 0.01}) {
      for (const char* solver : {"", "solver: {name: newton, tolerance: 1e-8, iterations: 50}\n",
                                 "solver: {name: gauss_seidel}\n"}) {
        EXPECT_LT(creep(scene_of(shape, time_step, solver)), 3e-6)
            << std::get<0>(shape) << ", " << time_step << " s, " << solver;
      }
    }
  }
  EXPECT_LT(creep(scene_of(kBox, 0.01, "solver: {name: xpbd}\n")), 3e-6);
}

TEST(RigidBodies, DoNotCreepOnEachOther) {
  for (const double time_step : {0.002, 0.01}) {
    const auto world = world_of(fmt::format(
        "time_step: {}\nbodies:\n  - {{name: up, model: rigid, geometry: {{box: {{size: [0.05, "
        "0.05, "
        "0.05]}}}}, position: [0, 0, 0.0492], material: {{density: 500}}}}\n  - {{name: low, "
        "model: "
        "rigid, geometry: {{box: {{size: [0.1, 0.1, 0.02]}}}}, position: [0, 0, 0.011], material: "
        "{{density: 500}}}}\nobstacles: [{{name: floor, shape: plane}}]\neffects:\n  gravity: "
        "{{acceleration: [3.0, 0, -9.3]}}\n  contact: {{thickness: 0.002}}\n  friction: "
        "{{coefficient: 0.5}}\n  body_contact: {{thickness: 0.002, friction: 0.5}}\n",
        time_step));
    const auto middle = [&](const char* name) {
      return body_named(*world, name).particles().center_of_mass();
    };
    run_for(*world, 0.3);
    const Eigen::Vector3d up = middle("up"), low = middle("low");
    run_for(*world, 0.5);
    EXPECT_LT((middle("up") - up).norm(), 3e-6) << time_step;
    EXPECT_LT((middle("low") - low).norm(), 3e-6) << time_step;
  }
}

TEST(RigidBodies, StillSlideDownAsCoulombSays) {
  std::string scene = scene_of(kBox, 0.005, "");
  scene.replace(scene.find("coefficient: 0.5"), 16, "coefficient: 0.2");
  const auto world = world_of(scene);
  const Particles& p = world->bodies().front().particles();
  run_for(*world, 0.2);
  const double before = p.momentum().x() / p.mass.sum();
  run_for(*world, 0.3);
  const double acceleration = (p.momentum().x() / p.mass.sum() - before) / 0.3;
  EXPECT_NEAR(acceleration, 3.0 - 0.2 * 9.3, 1e-3);
}

}  // namespace
}  // namespace pliant::rigid_creep_test
