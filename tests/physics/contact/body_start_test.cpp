// Bodies that begin nearer to each other than they should be.
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

INSTANTIATE_TEST_SUITE_P(Models, StartTooNear, testing::Values("rigid", "patch", "cloth"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace pliant::body_start_physics_test
