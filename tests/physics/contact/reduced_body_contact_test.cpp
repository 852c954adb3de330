// Reduced bodies and others that touch them: forces, passes, energy, repetition.
#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/distance/winding_count.h"
#include "pliant/math/error.h"
#include "support/measures.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::reduced_body_contact_test {
namespace {

constexpr double kGravity = 9.81;
const char* const kEffects =
    "  gravity: {}\n  contact: {thickness: 0.001}\n  friction: {}\n  damping: {rate: 2}\n"
    "  body_contact: {thickness: 0.001}\n";
const char* const kPlane = "obstacles: [{name: table, shape: plane}]\n";

/// A heart of 0.07 m that stands on its tip, which is held.
std::string heart(const std::string& name, double x, const std::string& more = "") {
  return fmt::format(
      "  - {{name: {}, model: reduced, geometry: {{example: {{name: heart, scale: 0.03, young: "
      "3.0e+4}}}}, material: {{alpha: 1.0, beta: 5.0e-4}}, position: [{}, 0, 0.0315]{}}}\n",
      name, x, more.empty() ? "" : ", " + more);
}

/// What lies or falls on the heart's top, which is at z = 0.07 m.
std::string upper(const std::string& model, double z, const std::string& more = "") {
  const std::string shape =
      model == "cloth"   ? "geometry: {grid: {size: [0.1, 0.1], vertices: [9, 9]}}, material: "
                           "{areal_density: 0.3, bending: 1.0e-4}"
      : model == "patch" ? "geometry: {block: {size: [0.06, 0.06, 0.02], cells: [3, 3, 1]}}, "
                           "material: {young: 1.0e+5, density: 300}"
      : model == "rigid" ? "geometry: {box: {size: [0.06, 0.06, 0.02]}}, material: {density: 300}"
                         : "geometry: {block: {size: [0.06, 0.06, 0.02]}, particles: 80}, "
                           "material: {state: elastic, density: 300}";
  return fmt::format("  - {{name: upper, model: {}, {}, position: [0.002, 0.001, {}]{}}}\n", model,
                     shape, z, more.empty() ? "" : ", " + more);
}

/// The drawn surface of particles may dip into what they lie on; they themselves may not.
void expect_apart(World& world) {
  Body& upper = body_named(world, "upper");
  if (upper.model->ball_volumes() == nullptr) {
    EXPECT_EQ(intersections_between(world), 0) << "at " << world.time() << " s";
    return;
  }
  const WindingCount within(body_named(world, "heart").model->surface());
  for (const auto x : upper.particles().x.colwise()) {
    EXPECT_EQ(within(x), 0) << "at " << world.time() << " s";
  }
}

class OnAReducedBody : public testing::TestWithParam<std::string> {};

TEST_P(OnAReducedBody, LiesWithItsWeight) {
  const double z = GetParam() == "cloth" ? 0.075 : 0.085;
  const auto world =
      world_of(scene_text({heart("heart", 0.0), upper(GetParam(), z)}, kEffects, kPlane));
  for (int k = 0; k < 120; ++k) ASSERT_TRUE(world->step()) << world->failure();
  constexpr int kSteps = 40;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world->step());
    const Eigen::Vector3d on_upper = contact_force_on(*world, "upper");
    const Eigen::Vector3d on_heart = contact_force_on(*world, "heart");
    EXPECT_LT((on_upper + on_heart).norm(), 1e-12 * (1.0 + on_upper.norm()));
    force += on_upper / kSteps;
  }
  const double weight = kGravity * mass_of(*world, "upper");
  EXPECT_NEAR(force.z(), weight, 0.01 * weight);
  expect_apart(*world);
}

TEST_P(OnAReducedBody, DoesNotPassAtFiveMetresASecond) {
  const auto world = world_of(scene_text(
      {heart("heart", 0.0), upper(GetParam(), 0.1, "velocity: [0, 0, -5]")}, kEffects, kPlane));
  const double before = energy_under_gravity(*world);
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    expect_apart(*world);
    EXPECT_LT(energy_under_gravity(*world), 1.02 * before) << "step " << k;
  }
}

TEST_P(OnAReducedBody, IsPushedByTheForcesThatAreTold) {
  // The heart is held: only what flies at it has all of its momentum from contact.
  const auto world =
      world_of(scene_text({heart("heart", 0.0), upper(GetParam(), 0.1, "velocity: [0.1, 0, -1]")},
                          "  body_contact: {thickness: 0.001, friction: 0.3}\n"));
  const Particles& p = body_named(*world, "upper").particles();
  const Eigen::Vector3d first = p.momentum();
  for (int k = 0; k < 24; ++k) {
    const Eigen::Vector3d before = p.momentum();
    ASSERT_TRUE(world->step()) << world->failure();
    const Eigen::Vector3d impulse = world->time_step() * contact_force_on(*world, "upper");
    ASSERT_LT((p.momentum() - before - impulse).norm(), 1e-10 * first.norm()) << "step " << k;
  }
  EXPECT_GT(p.momentum().z(), 0.5 * first.z()) << "it was pushed";
}

INSTANTIATE_TEST_SUITE_P(Models, OnAReducedBody,
                         testing::Values("cloth", "patch", "rigid", "viscoelastic"),
                         [](const auto& info) { return info.param; });

TEST(ReducedBodyContact, TwoOfThemCollide) {
  const auto world = world_of(scene_text(
      {heart("left", 0.0), heart("right", 0.09, "velocity: [-2.5, 0, 0]")}, kEffects, kPlane));
  const double before = energy_under_gravity(*world);
  double pushed = 0.0;
  for (int k = 0; k < 80; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    ASSERT_EQ(intersections_between(*world), 0) << "step " << k;
    EXPECT_LT(energy_under_gravity(*world), 1.02 * before) << "step " << k;
    pushed = std::min(pushed, contact_force_on(*world, "left").x());
  }
  EXPECT_LT(pushed, -0.5);
  // Nothing is known of the error of bodies of coordinates, and nothing is said.
  for (const Body& body : world->bodies()) EXPECT_FALSE(body.report.error) << body.name;
}

TEST(ReducedBodyContact, TellsTheErrorOfBodiesThatHaveOne) {
  for (const bool heart_first : {true, false}) {
    std::vector<std::string> bodies = {heart("heart", 0.0), upper("patch", 0.083)};
    if (!heart_first) std::swap(bodies[0], bodies[1]);
    const auto world = world_of(scene_text(bodies, kEffects, kPlane));
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
    EXPECT_FALSE(body_named(*world, "heart").report.error);
    EXPECT_TRUE(body_named(*world, "upper").report.error);
    EXPECT_EQ(body_named(*world, "heart").report.solver, "trigonometric");
    EXPECT_EQ(body_named(*world, "upper").report.solver, "lbfgs");
  }
}

TEST(ReducedBodyContact, IsTheSameForAnyNumberOfThreadsAndAfterALoad) {
  const std::string text =
      scene_text({heart("heart", 0.0), upper("patch", 0.083)}, kEffects, kPlane);
  const auto state_of = [](World& world) {
    Positions all = body_named(world, "heart").particles().x;
    const Positions& own = body_named(world, "upper").particles().x;
    all.conservativeResize(3, all.cols() + own.cols());
    all.rightCols(own.cols()) = own;
    return all;
  };
  const auto end = [&](int threads) {
    set_threads(threads);
    const auto world = world_of(text);
    for (int k = 0; k < 40; ++k) EXPECT_TRUE(world->step());
    set_threads(1);
    return state_of(*world);
  };
  const Positions one = end(1);
  EXPECT_EQ(one, end(2));
  EXPECT_EQ(one, end(4));
  const auto world = world_of(text);
  for (int k = 0; k < 25; ++k) ASSERT_TRUE(world->step());
  ASSERT_GT(contact_force_on(*world, "upper").norm(), 0.0);
  const Checkpoint saved = world->save();
  for (int k = 0; k < 15; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(state_of(*world), one);
  world->load(saved);
  for (int k = 0; k < 15; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(state_of(*world), one);
  world->reset();
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(state_of(*world), one);
}

TEST(ReducedBodyContact, ObstaclesHoldWhatAnotherBodyPushes) {
  // A wall beside the heart; a block thrown at its other side.
  const std::string block =
      "  - {name: block, model: patch, geometry: {block: {size: [0.02, 0.04, 0.04], cells: [1, 2, "
      "2]}}, material: {young: 1.0e+5, density: 2000}, position: [0.055, 0, 0.045], velocity: [-2, "
      "0, 0]}\n";
  const auto world =
      world_of(scene_text({heart("heart", 0.0), block},
                          "  contact: {thickness: 0.001}\n  body_contact: {thickness: 0.001}\n",
                          "obstacles: [{name: wall, shape: plane, position: [-0.042, 0, 0], "
                          "rotation_rpy: [0, 1.5707963, "
                          "0]}]\n"));
  double reaction = 0.0;
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_GT(body_named(*world, "heart").particles().x.row(0).minCoeff(), -0.0425) << k;
    ASSERT_EQ(intersections_between(*world), 0) << "step " << k;
    reaction = std::min(reaction, world->reactions().front().force.x());
  }
  EXPECT_LT(reaction, -0.1);
}

// A beam, held at one end, is pressed on a plate by more points than the two bodies have
// coordinates, and is stiff against bending: sweeps that see the plate as loose particles would not
// have found its forces after a hundred.
TEST(ReducedBodyContact, AStiffBeamAndARigidPlateAgreeInAFewCorrections) {
  const std::string beam =
      "  - {name: beam, model: reduced, geometry: {example: {name: beam, scale: 0.1, young: "
      "1.0e+7, rank: 6, modes: 4}, contact_spacing: 0.01}, position: [-0.05, 0, 0.0272]}\n";
  const std::string plate =
      "  - {name: plate, model: rigid, geometry: {box: {size: [0.12, 0.12, 0.02]}, "
      "contact_spacing: 0.02}, position: [0, 0, 0.0112]}\n";
  const auto world = world_of(scene_text({beam, plate},
                                         "  gravity: {}\n  damping: {rate: 2}\n  contact: "
                                         "{thickness: 0.002}\n  body_contact: {thickness: 0.002}\n",
                                         kPlane));
  const double weight = kGravity * body_named(*world, "plate").particles().mass.sum();
  double force = 0.0;
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    if (k < 40) continue;
    const StepReport& report = body_named(*world, "plate").report;
    EXPECT_LE(report.iterations, 6) << k;
    EXPECT_EQ(report.ended_by, EndedBy::kRoundOff) << k;
    const double last = std::exchange(force, -world->reactions().front().force.z());
    EXPECT_GT(force, 1.001 * weight) << k;
    if (k > 40) {
      EXPECT_NEAR(force, last, 1e-4 * weight) << k;
    }
  }
}

TEST(ReducedBodyContact, SolversThatKeepConstraintsInTheirMatrixAreRefused) {
  const std::string text = scene_text(
      {heart("heart", 0.0), upper("patch", 0.083, "solver: {name: newton}")}, kEffects, kPlane);
  try {
    world_of(text);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'newton' of body 'upper'"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace pliant::reduced_body_contact_test
