// Bodies at rest on each other: what steps take, and what they tell of the forces.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::resting_rigid_bodies_test {
namespace {

// Contact bends the four particles of a rigid body within each step. Where steps began with its own
// shape, a first iteration did nothing else, and this scene took three a step.
TEST(RestingRigidBodies, TakeAnIterationAStep) {
  auto world = world_of(
      scene_text({slab("soft", "patch", 0.027), slab("on_it", "rigid", 0.079),
                  "  - {name: beside, model: rigid, geometry: {box: {size: [0.06, 0.06, 0.04]}}, "
                  "material: {density: 800}, position: [0.2, 0, 0.022]}\n"},
                 "  gravity: {acceleration: [0, 0, -9.81]}\n  contact: {thickness: 0.002}\n"
                 "  friction: {coefficient: 0.5}\n"
                 "  body_contact: {thickness: 0.002, friction: 0.4}\n",
                 "obstacles: [{name: table, shape: plane}]\n"
                 "solver: {name: newton, tolerance: 1e-3, linear_tolerance: 0.03}\n"));
  run_for(*world, 0.9);
  int iterations = 0;
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    iterations += world->bodies().front().report.iterations;
  }
  EXPECT_LE(iterations, 25);
}

constexpr const char* kTouching =
    "  gravity: {acceleration: [0, 0, -9.81]}\n  contact: {thickness: 0.002}\n"
    "  friction: {coefficient: 0.5}\n  body_contact: {thickness: 0.002, friction: 0.5}\n";

std::string box(const std::string& name, double side, double height) {
  return fmt::format(
      "  - {{name: {}, model: rigid, geometry: {{box: {{size: [{}, {}, 0.04]}}}}, "
      "material: {{density: 800}}, position: [0, 0, {}]}}\n",
      name, side, side, height);
}

class CornersOfRigidBodies : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(Solvers, CornersOfRigidBodies,
                         testing::Values("{name: xpbd, iterations: 50}", "{name: newton}"),
                         [](const auto& info) { return info.index == 0 ? "xpbd" : "newton"; });

// Hundreds of points of their faces touch; four say all that these say, of the table and of the
// lower box.
TEST_P(CornersOfRigidBodies, CarryAStack) {
  auto world = world_of(scene_text(
      {box("low", 0.1, 0.021), box("high", 0.06, 0.063)}, kTouching,
      "obstacles: [{name: table, shape: plane}]\nsolver: " + std::string(GetParam()) + "\n"));
  run_for(*world, 0.5);
  double weight = 0.0;
  int contacts = 0;
  for (const auto& body : world->bodies()) {
    weight += 9.81 * body.particles().mass.sum();
    contacts += body.report.contacts;
    EXPECT_LT(body.particles().v.norm(), 1e-3);
  }
  EXPECT_LE(contacts, 16);
  EXPECT_GE(contacts, 6);
  EXPECT_NEAR(world->reactions().front().force.z(), -weight, 1e-3 * weight);
}

// Forces at the corners stop it as docs/contact.md says: their lever is half of the diagonal.
TEST_P(CornersOfRigidBodies, StopASpin) {
  constexpr double kSide = 0.4, kSpin = 25.0;
  auto world = world_of(scene_text(
      {box("box", kSide, 0.021)}, kTouching,
      "obstacles: [{name: table, shape: plane}]\nsolver: " + std::string(GetParam()) + "\n"));
  Particles& particles = world->bodies().front().particles();
  for (int i = 0; i < particles.size(); ++i) {
    particles.v.col(i) =
        kSpin * Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d(particles.x.col(i)));
  }
  constexpr double kTime = 0.3;
  const double slowing = 0.5 * 9.81 * 6.0 / (std::sqrt(2.0) * kSide);
  run_for(*world, kTime);
  const Eigen::Vector3d arm = particles.x.col(0) - particles.x.rowwise().mean();
  const Eigen::Vector3d v = particles.v.col(0) - particles.v.rowwise().mean();
  const double spin = arm.cross(v).z() / arm.head<2>().squaredNorm();
  EXPECT_NEAR(kSpin - spin, slowing * kTime, 0.02 * slowing * kTime);
}

// Wet cloth: its contact forces are found before the first iteration, which may then have nothing
// left to do.
TEST(RestingWetCloth, TellsItsWeightWhereAStepIsDoneAtOnce) {
  auto world = world_of(scene_text(
      {"  - {name: main, model: cloth, geometry: {grid: {size: [0.1, 0.1], vertices: [6, "
       "6]}}, material: {areal_density: 0.15}, position: [0, 0, 0.0021]}\n"},
      "  gravity: {acceleration: [0, 0, -9.81]}\n  damping: {rate: 2}\n"
      "  contact: {thickness: 0.002}\n  friction: {coefficient: 0.4}\n"
      "  wetness: {wetness: 0.8, capacity: 0.2, adhesion: 1440}\n",
      "obstacles: [{name: table, shape: plane}]\n"
      "solver: {name: newton, tolerance: 1e-6}\n"));
  run_for(*world, 0.3);
  const double mass = world->bodies().front().particles().mass.sum();
  for (int k = 0; k < 5; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    const StepReport& report = world->bodies().front().report;
    EXPECT_NEAR(world->reactions().front().force.z(), -9.81 * mass, 1e-3 * 9.81 * mass);
    EXPECT_LT(report.impulse_imbalance.value_or(1.0), 1e-6);
  }
}

}  // namespace
}  // namespace pliant::resting_rigid_bodies_test
