// Bodies that begin nearer to each other than they should be.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::body_start_physics_test {
namespace {

const char* const kHeld =
    "attachments: [{name: hold, sphere: {center: [0, 0, 0], radius: 1}, to: world, stiffness: "
    "1.0e+6}]";

double lowest_of(World& world, const std::string& name) {
  return body_named(world, name).model->surface().vertices.row(2).minCoeff();
}

double highest_of(World& world, const std::string& name) {
  return body_named(world, name).model->surface().vertices.row(2).maxCoeff();
}

class StartTooNear : public testing::TestWithParam<std::string> {};

TEST_P(StartTooNear, OpensGently) {
  // Without gravity nothing else moves them.
  const double thickness = GetParam() == "cloth" ? 0.0 : 0.05, missing = 0.001;
  const auto world =
      world_of(scene_text({slab("lower", "rigid", 0.0, kHeld),
                           slab("upper", GetParam(), 0.025 + 0.002 - missing + 0.5 * thickness)},
                          "  body_contact: {}\n"));
  double fastest = 0.0, most = 0.0;
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(world->step());
    const Particles& particles = body_named(*world, "upper").particles();
    fastest = std::max(fastest, std::sqrt(particles.v.colwise().squaredNorm().maxCoeff()));
    most = std::max(most, world->energies().kinetic);
  }
  // They should part with 2 cm/s, all at once it would be 20 cm/s; where a wave comes to the free
  // surface of an elastic body it doubles the speed.
  const double gentle = (GetParam() == "rigid" ? 1.1 : 2.0) * 0.02;
  EXPECT_LT(fastest, gentle);
  EXPECT_LT(most, 0.5 * (mass_of(*world, "upper") + mass_of(*world, "lower")) * gentle * gentle);
  EXPECT_GT(lowest_of(*world, "upper") - highest_of(*world, "lower"), 0.002 - 1e-5);
}

TEST_P(StartTooNear, RestsWhereItShould) {
  const double thickness = GetParam() == "cloth" ? 0.0 : 0.05, missing = 0.001;
  const auto world =
      world_of(scene_text({slab("lower", "rigid", 0.0, kHeld),
                           slab("upper", GetParam(), 0.025 + 0.002 - missing + 0.5 * thickness)},
                          "  gravity: {}\n  body_contact: {}\n"));
  double fastest = 0.0;
  for (int k = 0; k < 160; ++k) {
    ASSERT_TRUE(world->step());
    const Particles& particles = body_named(*world, "upper").particles();
    fastest = std::max(fastest, particles.momentum().norm() / particles.mass.sum());
  }
  EXPECT_LT(fastest, 1.1 * 0.02);
  EXPECT_NEAR(lowest_of(*world, "upper") - highest_of(*world, "lower"), 0.002, 1e-4);
}

TEST(BodyContactStart, IsTheSameAfterALoadAResetAndAnUndoneStep) {
  const auto world =
      world_of(scene_text({slab("lower", "rigid", 0.0, kHeld), slab("upper", "patch", 0.051)},
                          "  gravity: {}\n  body_contact: {}\n", "limits: {max_speed: 5}\n"));
  const auto end_after = [&](int steps) {
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
    return body_named(*world, "upper").particles().x;
  };
  const Positions one = end_after(12);
  world->reset();
  end_after(5);
  const Checkpoint saved = world->save();
  EXPECT_EQ(end_after(7), one);
  world->load(saved);
  EXPECT_EQ(end_after(7), one);
  world->load(saved);
  throw_away(*world);
  EXPECT_FALSE(world->step());
  world->applied_forces().clear();
  EXPECT_EQ(end_after(7), one);
}

// Where particles end below the surface is known to nobody who writes a scene: a block whose box
// lies at its distance from the ground has some of them 0.1 mm too deep. It used to jump at 0.8 m/s
// where it is stiff.
class BlockPutDown : public testing::TestWithParam<double> {};

TEST_P(BlockPutDown, IsLiftedGently) {
  const double young = GetParam();
  const auto world = world_of(fmt::format(
      "time_step: {}\nbodies:\n  - {{name: block, model: viscoelastic, geometry: {{block: {{size: "
      "[0.06, 0.06, 0.03]}}, spacing: 0.01}}, position: [0, 0, 0.015], material: {{young: {}}}}}\n"
      "obstacles:\n  - {{name: ground, shape: plane}}\neffects:\n  gravity: {{}}\n"
      "  contact: {{thickness: 0.01}}\n  friction: {{}}\n",
      young > 1e7 ? 0.00025 : 0.002, young));
  const Particles& particles = world->bodies().front().particles();
  const double start = particles.center_of_mass().z();
  double fastest = 0.0, highest = 0.0;
  while (world->time() < 0.1) {
    ASSERT_TRUE(world->step());
    fastest = std::max(fastest, particles.momentum().norm() / particles.mass.sum());
    highest = std::max(highest, particles.center_of_mass().z() - start);
  }
  // At 2 cm/s, which a wave doubles, and no farther than it lay too deep and such a throw goes.
  EXPECT_LT(fastest, 0.04);
  EXPECT_LT(highest, 0.0005);
}

TEST(BlockPutDownAgain, IsLiftedAlikeAfterALoadAResetAndAnUndoneStep) {
  const auto world =
      world_of(scene_text({slab("block", "patch", 0.0255)}, "  gravity: {}\n  contact: {}\n",
                          "limits: {max_speed: 5}\n"
                          "obstacles: [{name: table, shape: plane}]\n"));
  const Particles& particles = world->bodies().front().particles();
  const auto end_after = [&](int steps) {
    for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
    return particles.x;
  };
  throw_away(*world);
  EXPECT_FALSE(world->step());
  world->applied_forces().clear();
  const double start = particles.x.row(2).minCoeff();
  const Positions one = end_after(3);
  EXPECT_LT(one.row(2).minCoeff(), 0.001) << "it is on its way";
  EXPECT_GT(one.row(2).minCoeff(), start + 1e-4);
  world->reset();
  end_after(1);
  const Checkpoint saved = world->save();
  EXPECT_EQ(end_after(2), one);
  world->load(saved);
  throw_away(*world);
  EXPECT_FALSE(world->step());
  world->applied_forces().clear();
  EXPECT_EQ(end_after(2), one);
}

INSTANTIATE_TEST_SUITE_P(Young, BlockPutDown, testing::Values(1e4, 1e6, 1e8));

INSTANTIATE_TEST_SUITE_P(Models, StartTooNear, testing::Values("rigid", "patch", "cloth"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace pliant::body_start_physics_test
