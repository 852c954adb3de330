// A rigid body put down on the ground is right, with any solver and any time step, and so nothing
// may be said of an error: its contacts are hundreds, and its elements a single cluster.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::rigid_error_test {
namespace {

constexpr double kHalf = 0.035, kOffset = 0.001, kDrop = 0.005;  // [m]

struct Rested {
  int warned = 0;       ////< steps
  double error = 0.0;   ////< the largest that was reported
  double height = 0.0;  ///< of the middle at the end, above where it should be [m]
};

Rested put_down(const std::string& shape, const std::string& solver, double time_step) {
  const auto world = world_of(
      fmt::format("time_step: {}\nsolver: {{name: {}}}\nbodies:\n  - {{name: body, model: rigid, "
                  "geometry: {{{}}}, "
                  "position: [0, 0, {}], rotation_rpy: [0, 0, 0.2], material: {{density: 300}}}}\n"
                  "obstacles: [{{name: ground, shape: plane}}]\n"
                  "effects:\n  gravity: {{}}\n  contact: {{}}\n  friction: {{coefficient: 0.8}}\n",
                  time_step, solver, shape, kHalf + kOffset + kDrop));
  Rested rested;
  while (world->time() < 0.4) {
    EXPECT_TRUE(world->step()) << world->failure();
    rested.warned += warns(*world, "inaccurate");
    rested.error = std::max(rested.error, body_of(*world).report.error.value_or(0.0));
  }
  const Particles& p = world->bodies().front().particles();
  rested.height = p.center_of_mass().z() - kHalf - kOffset;
  return rested;
}

TEST(RigidError, NothingIsSaidOfABodyThatIsPutDown) {
  for (const auto* shape : {"box: {size: [0.07, 0.07, 0.07]}", "sphere: {radius: 0.035}"}) {
    for (const auto* solver : {"xpbd", "gauss_seidel", "chebyshev", "jacobi"}) {
      for (const double time_step : {0.001, 0.005, 0.01}) {
        const Rested rested = put_down(shape, solver, time_step);
        const std::string which = fmt::format("{} by {} at {} s", shape, solver, time_step);
        EXPECT_EQ(rested.warned, 0) << which << ": up to " << rested.error;
        EXPECT_LT(std::abs(rested.height), 0.01 * kDrop) << which;
      }
    }
  }
}

// Steps end in the body's own shape, which contact forces bend by micrometres within a step: a body
// whose steps are converged is right while it slides too.
TEST(RigidError, NothingIsFoundOfAConvergedBodyThatSlides) {
  for (const auto* solver : {"xpbd, iterations: 400", "newton, iterations: 40"}) {
    const auto world = world_of(fmt::format(
        "time_step: 0.005\nsolver: {{name: {}}}\nbodies:\n  - {{name: body, model: rigid, "
        "geometry: {{box: {{size: [0.05, 0.04, 0.03]}}}}, material: {{density: 800}}, position: "
        "[0, "
        "0, 0.016], rotation_rpy: [0, 0, 0.4], velocity: [0.8, 0.2, 0]}}\n"
        "obstacles: [{{name: ground, shape: plane}}]\n"
        "effects:\n  gravity: {{}}\n  contact: {{}}\n  friction: {{coefficient: 0.3}}\n",
        solver));
    double error = 0.0;
    while (world->time() < 0.2) {
      ASSERT_TRUE(world->step()) << world->failure();
      error = std::max(error, body_of(*world).report.error.value_or(0.0));
    }
    EXPECT_GT(world->bodies().front().particles().center_of_mass().x(), 0.05) << solver;
    EXPECT_LT(error, 1e-3) << solver;
  }
}

// A can is carried by sixty points of its rim, which settle in more rounds than four corners do: an
// estimate that ended before was told to be 12 % off, on and on.
TEST(RigidError, NothingIsSaidOfAConvergedCanThatSlides) {
  const auto world = world_of(
      "time_step: 0.005\nsolver: {name: newton, tolerance: 1e-3, iterations: 50}\nbodies:\n"
      "  - {name: body, model: rigid, geometry: {cylinder: {radius: 0.03, length: 0.08}}, "
      "material: "
      "{density: 600}, position: [0, 0, 0.0411]}\n"
      "obstacles: [{name: slope, shape: plane, friction: 0.5}]\n"
      "effects:\n  gravity: {acceleration: [5.886, 0, -7.848]}\n  contact: {}\n  friction: {}\n");
  int warned = 0;
  while (world->time() < 0.8) {
    ASSERT_TRUE(world->step()) << world->failure();
    warned += warns(*world, "inaccurate");
  }
  // Down a slope with a tangent of 0.75: (0.6 - 0.5 0.8) g t^2 / 2.
  EXPECT_NEAR(body_of(*world).particles().center_of_mass().x(), 0.1 * 9.81 * 0.64, 0.01);
  EXPECT_EQ(warned, 0);
}

// It turns by a radian in a step: what was left of a correction's error, which did not turn with
// it, looked like a bend that springs back, and grew to more than the whole way.
TEST(RigidError, NothingIsSaidOfAConvergedBallThatRollsFast) {
  const auto world = world_of(
      "time_step: 0.01\nsolver: {name: newton, tolerance: 1e-4, iterations: 50}\nbodies:\n"
      "  - {name: body, model: rigid, geometry: {sphere: {radius: 0.03}}, material: "
      "{density: 600}, position: [0, 0, 0.1]}\n"
      "obstacles: [{name: slope, shape: plane, friction: 0.5}]\n"
      "effects:\n  gravity: {acceleration: [5.886, 0, -7.848]}\n  contact: {}\n  friction: {}\n");
  double told = 0.0;
  while (world->time() < 1.0) {
    ASSERT_TRUE(world->step()) << world->failure();
    told = std::max(told, body_of(*world).report.error.value_or(1.0));
  }
  EXPECT_LT(told, 0.02);
}

}  // namespace
}  // namespace pliant::rigid_error_test
