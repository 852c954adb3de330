#include "pliant/core/checkpoint.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_refusal.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

/// Every effect that keeps something, in motion.
ClothScene full_scene(const std::string& solver) {
  return falling_scene(solver, 0.05,
                       {{"volume", "1e-4"}, {"fill_time", "0.1"}, {"permeability", "1e-6"}});
}

class CheckpointOfEverySolver : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(CheckpointOfEverySolver);

TEST_P(CheckpointOfEverySolver, GoesOnBitForBit) {
  auto world = make_world(full_scene(GetParam()));
  AppliedForce push;
  push.force = Eigen::Vector3d(0, 0.1, 0);
  push.duration = -1.0;
  world->applied_forces().add(push);
  run_for(*world, 0.06);
  const Checkpoint checkpoint = world->save();
  run_for(*world, 0.04);
  const Particles once = particles_of(*world);
  const double energy = world->energies().total();
  world->applied_forces().clear();
  particles_of(*world).fix(3);
  run_for(*world, 0.01);
  world->load(checkpoint);
  EXPECT_EQ(world->steps(), 60u);
  EXPECT_FALSE(particles_of(*world).is_fixed(3));
  run_for(*world, 0.04);
  EXPECT_EQ(particles_of(*world).x, once.x);
  EXPECT_EQ(particles_of(*world).v, once.v);
  EXPECT_EQ(world->energies().total(), energy);
}

TEST_P(CheckpointOfEverySolver, LoadsIntoATwin) {
  auto world = make_world(full_scene(GetParam()));
  run_for(*world, 0.06);
  auto twin = make_world(full_scene(GetParam()));
  twin->load(world->save());
  run_for(*world, 0.02);
  run_for(*twin, 0.02);
  EXPECT_EQ(particles_of(*twin).x, particles_of(*world).x);
  EXPECT_EQ(twin->time(), world->time());
}

TEST(Checkpoint, OfAnotherSceneIsRefusedAndChangesNothing) {
  auto world = make_world(full_scene("xpbd"));
  run_for(*world, 0.01);
  const Particles before = particles_of(*world);
  ClothScene finer = full_scene("xpbd");
  finer.grid = {0.3, 0.3, 8, 8};
  ClothScene calm = full_scene("xpbd");
  calm.effects.erase(calm.effects.begin() + 1);
  ClothScene other_step = full_scene("xpbd");
  other_step.time_step = 2e-3;
  for (const ClothScene& scene : {finer, calm, other_step}) {
    const Checkpoint checkpoint = make_world(scene)->save();
    expect_refusal([&] { world->load(checkpoint); }, {"load it into the scene that saved it"});
    EXPECT_EQ(particles_of(*world).x, before.x);
    EXPECT_EQ(world->steps(), 10u);
  }
}

TEST(StateArchive, ComeBackInOrderAndThenNaN) {
  StateArchive numbers;
  numbers.write(1.5);
  numbers.write(-2.0);
  EXPECT_EQ(numbers.size(), 2u);
  EXPECT_EQ(numbers.read(), 1.5);
  EXPECT_EQ(numbers.read(), -2.0);
  EXPECT_TRUE(std::isnan(numbers.read()));
  numbers.rewind();
  EXPECT_EQ(numbers.read(), 1.5);
}

}  // namespace
}  // namespace pliant
