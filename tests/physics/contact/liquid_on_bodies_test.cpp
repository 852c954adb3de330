// Liquids that meet other bodies: weight, momentum, energy; and bodies of particles that meet.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/body/blended_particles.h"
#include "support/known_defects.h"
#include "support/measures.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::liquid_on_bodies_test {
namespace {

constexpr double kGravity = 9.81, kSide = 0.06, kThickness = 0.001;  // [m]

/// A block of particles above z = 0.
std::string particles(const std::string& name, const std::string& state, double z,
                      const std::string& more = "") {
  return fmt::format(
      "  - {{name: {}, model: viscoelastic, geometry: {{block: {{size: [0.056, 0.056, 0.03]}}, "
      "particles: 100}}, material: {{state: {}, density: 1000, viscosity: 0.5, young: 1.0e+5}}, "
      "position: [0, 0, {}]{}}}\n",
      name, state, z, more.empty() ? "" : ", " + more);
}

/// What a basin has for its floor, its top at z = 0. A cloth is held at its border.
std::string floor(const std::string& model, const std::string& more = "") {
  const std::string shape =
      model == "cloth"
          ? "geometry: {grid: {size: [0.07, 0.07], vertices: [8, 8]}}, material: {areal_density: "
            "0.3}, solver: {name: xpbd, iterations: 40}, fixed: [{box: {min: [-1, -1, -1], max: "
            "[-0.034, 1, 1]}}, {box: {min: [0.034, "
            "-1, -1], max: [1, 1, 1]}}, {box: {min: [-1, -1, -1], max: [1, -0.034, 1]}}, {box: "
            "{min: [-1, 0.034, -1], max: [1, 1, 1]}}]"
      : model == "patch" ? "geometry: {block: {size: [0.06, 0.06, 0.02], cells: [3, 3, 1]}}, "
                           "material: {young: 1.0e+5, density: 500}"
                         : "geometry: {box: {size: [0.06, 0.06, 0.02]}}, material: {density: 500}, "
                           "solver: {name: xpbd, iterations: 50}";
  return fmt::format("  - {{name: lower, model: {}, {}, position: [0, 0, {}]{}}}\n", model, shape,
                     model == "cloth" ? 0.0 : -0.01, more.empty() ? "" : ", " + more);
}

/// Four walls about the floor, and what it lies on.
std::string basin(double ground) {
  std::string text =
      fmt::format("obstacles: [{{name: ground, shape: plane, position: [0, 0, {}]}}", ground);
  for (const int axis : {0, 1}) {
    for (const double side : {-1.0, 1.0}) {
      const double off = side * (0.5 * kSide + 0.5 * kThickness + 1e-4 + 0.05);
      text += fmt::format(
          ", {{name: wall_{}{}, shape: box, size: [{}, {}, 0.4], position: [{}, {}, 0]}}", axis,
          side < 0.0 ? "_low" : "_high", axis == 0 ? 0.1 : 0.3, axis == 0 ? 0.3 : 0.1,
          axis == 0 ? off : 0.0, axis == 0 ? 0.0 : off);
    }
  }
  return text + "]\n";
}

const char* const kEffects =
    "  gravity: {}\n  damping: {rate: 5}\n  contact: {thickness: 0.001}\n  body_contact: "
    "{thickness: 0.001}\n";

class LiquidOnABody : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<World> poured(double gap, const std::string& of_liquid = "") const {
    const double ground = GetParam() == "cloth" ? -0.5 : -0.02 - 0.5 * kThickness;
    return world_of(
        scene_text({floor(GetParam()), particles("upper", "liquid", 0.015 + gap, of_liquid)},
                   kEffects, basin(ground)));
  }
};

TEST_P(LiquidOnABody, CarriesItsWeight) {
  const auto world = poured(0.006);
  run_for(*world, 0.5);
  double carried = 0.0;
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    const Eigen::Vector3d force = contact_force_on(*world, "upper");
    EXPECT_LT((force + contact_force_on(*world, "lower")).norm(), 1e-12 * (1.0 + force.norm()));
    carried += force.z() / kSteps;
  }
  const double weight = kGravity * mass_of(*world, "upper");
  EXPECT_NEAR(carried, weight, 0.01 * weight);
}

TEST_P(LiquidOnABody, DoesNotPassAtFiveMetresASecond) {
  const auto world = poured(0.03, "velocity: [0, 0, -5]");
  const double before = energy_under_gravity(*world);
  for (int k = 0; k < 40; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_EQ(intersections_between(*world), 0) << "step " << k;
    EXPECT_LT(energy_under_gravity(*world), before) << "step " << k;
  }
  // A cloth is no solid: nothing of the liquid may be below it.
  const double lowest = body_named(*world, "lower").model->surface().vertices.row(2).minCoeff();
  EXPECT_GT(body_named(*world, "upper").particles().x.row(2).minCoeff(), lowest);
}

// A cloth's border is held here: it takes momentum.
class LiquidThrownAtABody : public testing::TestWithParam<std::string> {};

TEST_P(LiquidThrownAtABody, PushesItAndLosesNoMomentum) {
  if (const char* seen = known_defect()) GTEST_SKIP() << "known defect: " << seen;
  const auto world = world_of(
      scene_text({floor(GetParam()), particles("upper", "liquid", 0.024, "velocity: [0.1, 0, -1]")},
                 "  body_contact: {thickness: 0.001}\n"));
  const Eigen::Vector3d before = momentum_of(*world);
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(world->step()) << world->failure();
  EXPECT_LT((momentum_of(*world) - before).norm(), 1e-10 * before.norm());
  EXPECT_LT(body_named(*world, "lower").particles().momentum().z(), 0.1 * before.z());
}

INSTANTIATE_TEST_SUITE_P(Models, LiquidThrownAtABody, testing::Values("patch", "rigid"),
                         [](const auto& info) { return info.param; });

INSTANTIATE_TEST_SUITE_P(Models, LiquidOnABody, testing::Values("cloth", "patch", "rigid"),
                         [](const auto& info) { return info.param; });

/// Two bodies of particles, which are moved as one.
struct States {
  std::string lower, upper;
};

class ParticlesOnParticles : public testing::TestWithParam<States> {
 protected:
  static Eigen::Vector3d momentum_of_part(World& world, std::size_t number) {
    Body& body = world.bodies().front();
    const auto part = dynamic_cast<BlendedParticles&>(*body.model).blended_parts()[number];
    const Particles& p = body.particles();
    return p.v.middleCols(part.first, part.count) * p.mass.segment(part.first, part.count);
  }
};

TEST_P(ParticlesOnParticles, TheGroundCarriesBoth) {
  const auto world = world_of(scene_text(
      {particles("lower", GetParam().lower, 0.0155), particles("upper", GetParam().upper, 0.0515)},
      "  gravity: {}\n  damping: {rate: 5}\n  self_contact: {thickness: 0.001}\n  "
      "contact: {thickness: 0.001}\n  friction: {}\n",
      basin(0.0)));
  ASSERT_EQ(world->bodies().size(), 1u);
  run_for(*world, 0.6);
  const double mass = particles_of(*world).mass.sum(), seconds = 0.3;
  const Eigen::Vector3d before = momentum_of_part(*world, 1);
  double carried = 0.0;
  const int steps = static_cast<int>(std::lround(seconds / world->time_step()));
  for (int k = 0; k < steps; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    carried -= world->reactions()[0].force.z() / steps;
  }
  EXPECT_NEAR(carried, kGravity * mass, 0.01 * kGravity * mass);
  // What lies on top neither sinks nor rises faster than a hundredth of gravity tells.
  const Eigen::Vector3d gained = momentum_of_part(*world, 1) - before;
  EXPECT_LT(gained.norm(), 0.01 * 0.5 * kGravity * mass * seconds);
}

TEST_P(ParticlesOnParticles, PushEachOtherAndLoseNoMomentum) {
  const auto world =
      world_of(scene_text({particles("lower", GetParam().lower, 0.0),
                           particles("upper", GetParam().upper, 0.042, "velocity: [0.1, 0, -1]")},
                          "  self_contact: {thickness: 0.001}\n"));
  const Eigen::Vector3d before = momentum_of(*world);
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(world->step()) << world->failure();
  EXPECT_LT((momentum_of(*world) - before).norm(), 1e-10 * before.norm());
  EXPECT_LT(momentum_of_part(*world, 0).z(), 0.2 * before.z());
}

INSTANTIATE_TEST_SUITE_P(States, ParticlesOnParticles,
                         testing::Values(States{"elastic", "elastic"}, States{"elastic", "liquid"},
                                         States{"liquid", "liquid"}),
                         [](const auto& info) {
                           return info.param.lower + "_under_" + info.param.upper;
                         });

}  // namespace
}  // namespace pliant::liquid_on_bodies_test
