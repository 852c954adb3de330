// Scenes as users write them, with each solver at its own settings: what moves as a whole does so as
// external and contact forces demand, from soft to stiff.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <tuple>

#include "pliant/scene/scene.h"

namespace pliant::impulse_balance_test {
namespace {

constexpr double kGravity = 9.81, kMu = 0.5, kDt = 0.005;

/// The world of a scene's text.
std::unique_ptr<World> world_of(const std::string& text) {
  static int number = 0;
  const std::string path = testing::TempDir() + "impulses_" + std::to_string(getpid()) + "_" +
                           std::to_string(number++) + ".yaml";
  std::ofstream(path) << text;
  std::unique_ptr<World> world = load_scene(path).world;
  std::remove(path.c_str());
  return world;
}

std::string block(const std::string& model, const std::string& young) {
  if (model == "viscoelastic") {
    return "model: viscoelastic\n"
           "    geometry: {block: {size: [0.1, 0.1, 0.05]}, particles: 150}\n"
           "    material: {state: " +
           std::string(young == "rigid" ? "rigid" : "elastic, young: " + young) +
           ", density: 500}\n";
  }
  return "model: patch\n"
         "    geometry: {block: {size: [0.1, 0.1, 0.05], cells: [4, 4, 2]}}\n"
         "    material: {young: " +
         young + ", poisson: 0.3, density: 500}\n";
}

/// A block on a floor, with gravity turned by the angle of tangent `slope`.
std::string on_incline(const std::string& model, const std::string& young, double slope,
                       const std::string& solver, double height) {
  const double angle = std::atan(slope);
  return "time_step: 0.005\n"
         "bodies:\n"
         "  - name: b\n"
         "    " +
         block(model, young) + "    position: [0, 0, " + std::to_string(height) +
         "]\n"
         "obstacles: [{name: floor, shape: plane}]\n"
         "effects:\n"
         "  gravity: {acceleration: [" +
         std::to_string(kGravity * std::sin(angle)) + ", 0, " +
         std::to_string(-kGravity * std::cos(angle)) +
         "]}\n"
         "  contact: {thickness: 0.001}\n"
         "  friction: {coefficient: 0.5}\n"
         "solver: {name: " +
         solver + "}\n";
}

double mass_of(const World& world) {
  double mass = 0.0;
  for (const Body& body : world.bodies()) mass += body.particles().mass.sum();
  return mass;
}

Eigen::Vector3d momentum_of(const World& world) {
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (const Body& body : world.bodies()) momentum += body.particles().momentum();
  return momentum;
}

/// Of the bodies' mass, between the times `from` and `to` [s].
Eigen::Vector3d mean_acceleration(World& world, double from, double to) {
  const auto run_until = [&](double time) {
    while (world.time() < time - 0.5 * kDt) EXPECT_TRUE(world.step()) << world.failure();
    return momentum_of(world);
  };
  const Eigen::Vector3d before = run_until(from);
  return (run_until(to) - before) / mass_of(world) / (to - from);
}

using Case = std::tuple<const char*, const char*, const char*>;  // model, solver, Young's modulus

std::string name_of(const testing::TestParamInfo<Case>& info) {
  std::string young = std::get<2>(info.param);
  return std::string(std::get<0>(info.param)) + "_" + std::get<1>(info.param) + "_" + young;
}

class BlockOnIncline : public testing::TestWithParam<Case> {};

TEST_P(BlockOnIncline, SlidesAsFrictionLetsIt) {
  const auto [model, solver, young] = GetParam();
  auto world = world_of(on_incline(model, young, 0.75, solver, 0.0255));
  const double angle = std::atan(0.75);
  const double exact = kGravity * (std::sin(angle) - kMu * std::cos(angle));
  const Eigen::Vector3d a = mean_acceleration(*world, 0.2, 0.5);
  EXPECT_NEAR(a[0], exact, 0.01 * exact);
  EXPECT_NEAR(a[1], 0.0, 0.01 * exact);
}

TEST_P(BlockOnIncline, BelowTheAngleOfFrictionRests) {
  const auto [model, solver, young] = GetParam();
  auto world = world_of(on_incline(model, young, 0.4, solver, 0.0255));
  mean_acceleration(*world, 0.1, 0.4);
  const Eigen::Vector3d v = momentum_of(*world) / mass_of(*world);
  EXPECT_LT(v.norm(), 2e-3);
}

TEST_P(BlockOnIncline, MomentumChangesByTheImpulsesThatAreReported) {
  const auto [model, solver, young] = GetParam();
  // It falls a little, hits the floor, and slides.
  auto world = world_of(on_incline(model, young, 0.75, solver, 0.03));
  const double angle = std::atan(0.75), mass = mass_of(*world);
  const Eigen::Vector3d weight =
      mass * kGravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  for (int k = 0; k < 60; ++k) {
    const Eigen::Vector3d before = momentum_of(*world);
    ASSERT_TRUE(world->step()) << world->failure();
    const Eigen::Vector3d force = weight - world->reactions()[0].force;
    const Eigen::Vector3d missing = momentum_of(*world) - before - kDt * force;
    EXPECT_LT(missing.norm(), 1e-9 * kDt * (weight.norm() + world->reactions()[0].force.norm()))
        << "step " << k;
    EXPECT_LT(world->bodies()[0].report.impulse_imbalance, 1e-6) << "step " << k;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Patch, BlockOnIncline,
    testing::Combine(testing::Values("patch"),
                     testing::Values("jacobi", "weighted_jacobi", "gauss_seidel", "hybrid",
                                     "chebyshev", "direct", "lbfgs", "xpbd"),
                     testing::Values("2e4", "1e6", "1e8")),
    name_of);
INSTANTIATE_TEST_SUITE_P(Viscoelastic, BlockOnIncline,
                         testing::Combine(testing::Values("viscoelastic"),
                                          testing::Values("jacobi", "chebyshev", "lbfgs"),
                                          testing::Values("1e5", "1e7", "rigid")),
                         name_of);

class ThrownBlock : public testing::TestWithParam<Case> {};

TEST_P(ThrownBlock, ComesToRestByFriction) {
  const auto [model, solver, young] = GetParam();
  std::string text = on_incline(model, young, 0.0, solver, 0.0255);
  text.insert(text.find("obstacles"), "    velocity: [1, 0, 0]\n");
  auto world = world_of(text);
  const Eigen::Vector3d a = mean_acceleration(*world, 0.05, 0.15);
  EXPECT_NEAR(a[0], -kMu * kGravity, 0.02 * kMu * kGravity);
  mean_acceleration(*world, 0.2, 0.4);
  EXPECT_LT((momentum_of(*world) / mass_of(*world)).norm(), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(Patch, ThrownBlock,
                         testing::Combine(testing::Values("patch"),
                                          testing::Values("chebyshev", "direct", "xpbd"),
                                          testing::Values("1e5", "1e7")),
                         name_of);

}  // namespace
}  // namespace pliant::impulse_balance_test
