// Round bodies that roll on a plane without slipping: nothing stops them, and their middle stays at
// its height.
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::rolling_test {
namespace {

constexpr double kRadius = 0.035, kOffset = 0.001, kSpeed = 0.2;  // [m, m, m/s]

struct Rolled {
  double swing = 0.0;   ///< of the middle's height [m]
  double height = 0.0;  ///< of its mean above the plane [m]
  double speed = 0.0;   ///< at the end, over that of the start
};

/// Of 0.6 s, after 0.3 s in which it comes to rest.
Rolled roll(const std::string& body, double time_step = 0.005) {
  const auto world = world_of(
      fmt::format("time_step: {}\nbodies:\n  - {{name: ball, {}}}\nobstacles: [{{name: ground, "
                  "shape: plane}}]\n"
                  "effects:\n  gravity: {{}}\n  contact: {{}}\n  friction: {{coefficient: 0.8}}\n",
                  time_step, body));
  run_for(*world, 0.3);
  Particles& p = world->bodies().front().particles();
  const Eigen::Vector3d middle = p.center_of_mass();
  const Eigen::Vector3d turn(0.0, kSpeed / kRadius, 0.0);
  for (int i = 0; i < p.size(); ++i) {
    p.v.col(i) = Eigen::Vector3d(kSpeed, 0, 0) + turn.cross(p.x.col(i) - middle);
  }
  Rolled rolled;
  double low = 1.0, high = 0.0;
  int steps = 0;
  const double end = world->time() + 0.6;
  while (world->time() < end) {
    EXPECT_TRUE(world->step()) << world->failure();
    const double height = p.center_of_mass().z();
    low = std::min(low, height);
    high = std::max(high, height);
    rolled.height += height;
    ++steps;
  }
  rolled.height /= steps;
  rolled.swing = high - low;
  rolled.speed = p.momentum().x() / p.mass.sum() / kSpeed;
  std::printf("%s: swing %.3g mm, height off %.3g mm, speed %.5f\n", body.c_str(),
              1e3 * rolled.swing, 1e3 * (rolled.height - kRadius - kOffset), rolled.speed);
  return rolled;
}

// Points of their surface alone rolled over flats: a sphere lost a tenth of its speed.
TEST(Rolling, RigidRoundBodiesRollOn) {
  const char* const lying = "rotation_rpy: [1.5707963267948966, 0, 0]";
  for (const auto& [shape, pose] :
       {std::pair("sphere: {radius: 0.035}", "rotation_rpy: [0.3, 0.7, 0.2]"),
        std::pair("capsule: {radius: 0.035, length: 0.1}", lying),
        std::pair("cylinder: {radius: 0.035, length: 0.1}", lying)}) {
    const Rolled rolled = roll(fmt::format(
        "model: rigid, geometry: {{{}}}, position: [0, 0, 0.0361], {}, material: {{density: 300}}",
        shape, pose));
    EXPECT_LT(rolled.swing, 2e-6) << shape;
    // Contact presses into the cluster that holds a rigid body together, by its stiffness.
    EXPECT_NEAR(rolled.height, kRadius + kOffset, 1e-5) << shape;
    EXPECT_NEAR(rolled.speed, 1.0, 2e-3) << shape;
  }
}

/// Acceleration of a sphere that rolls down a slope of 0.2 rad, from 0.2 s to 0.6 s, over that of a
/// solid sphere, 5/7 g sin.
double share_of_acceleration(const std::string& solver, double time_step) {
  const double slope = 0.2, g = 9.81;
  const auto world = world_of(fmt::format(
      "time_step: {}\nbodies:\n  - {{name: ball, model: rigid, geometry: {{sphere: {{radius: "
      "0.035}}}}, "
      "position: [0, 0, 0.036], rotation_rpy: [0.3, 0.7, 0.2], material: {{density: 300}}}}\n"
      "obstacles: [{{name: slope, shape: plane}}]\neffects:\n  gravity: {{acceleration: [{}, 0, "
      "{}]}}\n"
      "  contact: {{}}\n  friction: {{coefficient: 0.8}}\nsolver: {{name: {}}}\n",
      time_step, g * std::sin(slope), -g * std::cos(slope), solver));
  const Particles& p = world->bodies().front().particles();
  run_for(*world, 0.2);
  const double start = world->time(), before = p.momentum().x() / p.mass.sum();
  run_for(*world, 0.4);
  const double gained = p.momentum().x() / p.mass.sum() - before;
  return gained / (world->time() - start) / (5.0 / 7.0 * g * std::sin(slope));
}

TEST(Rolling, ASphereRollsDownASlopeAsFastAsASphereDoes) {
  for (const char* solver :
       {"xpbd", "jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev"}) {
    EXPECT_NEAR(share_of_acceleration(solver, 0.005), 1.0, 5e-3) << solver;
    EXPECT_NEAR(share_of_acceleration(solver, 0.002), 1.0, 2e-3) << solver;
  }
}

/// Of a round body of 3 cm radius that rolls down a slope of 0.64 rad from rest, its acceleration
/// in the first and in the last 0.1 s of 0.7 s, over `share` of g sin, as which it rolls. It turns
/// by up to one radian a step.
std::pair<double, double> shares_of_acceleration(const std::string& shape, double share,
                                                 const std::string& solver, double time_step) {
  const double slope = 0.64, g = 9.81;
  const auto world = world_of(fmt::format(
      "time_step: {}\nbodies:\n  - {{name: ball, model: rigid, geometry: {{{}}}, position: [0, 0, "
      "0.031], rotation_rpy: [1.5707963267948966, 0, 0], material: {{density: 600}}}}\n"
      "obstacles: [{{name: slope, shape: plane}}]\neffects:\n  gravity: {{acceleration: [{}, 0, "
      "{}]}}\n  contact: {{}}\n  friction: {{coefficient: 0.8}}\n{}",
      time_step, shape, g * std::sin(slope), -g * std::cos(slope), solver));
  const Particles& p = world->bodies().front().particles();
  const auto gained = [&](double seconds) {
    const double start = world->time(), before = p.momentum().x() / p.mass.sum();
    run_for(*world, seconds);
    const double speed = p.momentum().x() / p.mass.sum();
    return (speed - before) / (world->time() - start) / (share * g * std::sin(slope));
  };
  run_for(*world, 0.1);
  const double first = gained(0.1);
  run_for(*world, 0.4);
  return {first, gained(0.1)};
}

// What a surface rolls is more than the chords that points of it go, and contact turns a body
// further than its step predicts: at 10 ms a sphere lost a third of its acceleration at 100 rad/s.
TEST(Rolling, ASphereGainsAsMuchSpeedFastAsSlow) {
  for (const char* name : {"", "newton", "xpbd", "jacobi", "line_search_jacobi", "gauss_seidel",
                           "hybrid", "chebyshev"}) {
    const std::string solver = *name == 0 ? "" : fmt::format("solver: {{name: {}}}\n", name);
    for (const double time_step : {0.005, 0.01}) {
      const auto [first, last] =
          shares_of_acceleration("sphere: {radius: 0.03}", 5.0 / 7.0, solver, time_step);
      EXPECT_NEAR(first, 1.0, 2e-3) << name << time_step;
      EXPECT_NEAR(last, 1.0, 2e-3) << name << time_step;
    }
  }
}

TEST(Rolling, ASphereGoesOnFromASavedStateBitForBit) {
  const auto world = world_of(
      "time_step: 0.01\nbodies:\n  - {name: ball, model: rigid, geometry: {sphere: {radius: "
      "0.03}}, position: [0, 0, 0.04]}\nobstacles: [{name: slope, shape: plane}]\neffects:\n  "
      "gravity: {acceleration: [5, 0, -8]}\n  contact: {}\n  friction: {}\n");
  run_for(*world, 0.3);
  const Checkpoint saved = world->save();
  run_for(*world, 0.2);
  const Positions once = world->bodies().front().particles().x;
  world->load(saved);
  run_for(*world, 0.2);
  EXPECT_TRUE((world->bodies().front().particles().x.array() == once.array()).all());
}

TEST(Rolling, ACylinderGainsAsMuchSpeedFastAsSlow) {
  for (const char* name : {"", "newton", "jacobi", "chebyshev"}) {
    const std::string solver = *name == 0 ? "" : fmt::format("solver: {{name: {}}}\n", name);
    const auto [first, last] =
        shares_of_acceleration("cylinder: {radius: 0.03, length: 0.06}", 2.0 / 3.0, solver, 0.01);
    EXPECT_NEAR(first, 1.0, 5e-3) << name;
    EXPECT_NEAR(last, 1.0, 1e-2) << name;
  }
}

}  // namespace
}  // namespace pliant::rolling_test
