// Bodies at rest on each other: what steps take, and what they tell of the forces.
#include <gtest/gtest.h>

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
