// Free rigid bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/models/rigid/rigid.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::rigid_body_test {
namespace {

constexpr double kGravity = 9.81;

std::string body(const std::string& geometry, const std::string& more) {
  return "  - {name: body, model: rigid, geometry: " + geometry + ", " + more + "}\n";
}

RigidModel& rigid_of(World& world) {
  return dynamic_cast<RigidModel&>(*world.bodies().front().model);
}

Eigen::Vector3d spin_of(World& world) {
  const Particles& p = rigid_of(world).particles();
  return RigidModel::angular_momentum(p, p.x, p.v);
}

void set_spin(World& world, const Eigen::Vector3d& speed) {
  Particles& p = rigid_of(world).particles();
  const Eigen::Vector3d center = p.center_of_mass();
  for (int i = 0; i < p.size(); ++i) p.v.col(i) += speed.cross(p.x.col(i) - center);
}

TEST(RigidBody, HasTheMassAndInertiaOfItsShape) {
  const auto world = world_of(scene_text(
      {body("{box: {size: [0.1, 0.2, 0.3]}}", "material: {density: 800}")}, "  gravity: {}\n"));
  const RigidModel& model = rigid_of(*world);
  const double mass = 800 * 0.1 * 0.2 * 0.3;
  EXPECT_NEAR(model.mass(), mass, 1e-12 * mass);
  Eigen::Vector3d expected =
      mass / 12.0 * Eigen::Vector3d(0.2 * 0.2 + 0.3 * 0.3, 0.1 * 0.1 + 0.3 * 0.3, 0.05);
  Eigen::Vector3d found = model.moments();
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
}

TEST(RigidBody, GivenMassStandsForDensity) {
  const auto world = world_of(
      scene_text({body("{cylinder: {radius: 0.05, length: 0.1}}", "material: {mass: 0.7}")},
                 "  gravity: {}\n"));
  EXPECT_NEAR(rigid_of(*world).mass(), 0.7, 1e-12);
}

TEST(RigidBody, FallsFreely) {
  const auto world = world_of(scene_text(
      {body("{box: {size: [0.1, 0.2, 0.3]}}", "velocity: [1, 0, 2]")}, "  gravity: {}\n"));
  set_spin(*world, {3, 1, 2});
  const Eigen::Vector3d before = spin_of(*world);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(world->step());
  const double t = 0.5, h = 0.005;
  const Particles& p = rigid_of(*world).particles();
  // Implicit Euler falls h g t / 2 more than a parabola.
  EXPECT_LT(
      (p.center_of_mass() - Eigen::Vector3d(t, 0.0, 2.0 * t - 0.5 * kGravity * t * (t + h))).norm(),
      1e-9);
  EXPECT_LT((spin_of(*world) - before).norm(), 1e-9 * before.norm());
}

TEST(RigidBody, SpinsForAHundredThousandSteps) {
  const auto world =
      world_of(scene_text({body("{box: {size: [0.1, 0.2, 0.03]}}", "")}, "  damping: {rate: 0}\n"));
  // About the middle axis, with a little about the others: it tumbles.
  set_spin(*world, {10.0, 0.2, 0.3});
  const Eigen::Vector3d before = spin_of(*world);
  const double energy = world->energies().kinetic;
  double worst = 0.0;
  for (int k = 0; k < 100000; ++k) {
    ASSERT_TRUE(world->step());
    if (k % 100 == 0) worst = std::max(worst, std::abs(world->energies().kinetic - energy));
  }
  EXPECT_LT(worst, 1e-3 * energy);
  EXPECT_LT((spin_of(*world) - before).norm(), 1e-3 * before.norm());
}

TEST(RigidBody, ErrorsOfItsRotationAreOfSecondOrder) {
  const Eigen::Vector3d moments(1.0, 2.0, 3.5), momentum(1.0, 2.0, 0.7);
  const auto after = [&](int steps) {
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    for (int k = 0; k < steps; ++k) axes = rotated_freely(axes, moments, momentum, 2.0 / steps);
    return axes;
  };
  const Eigen::Matrix3d exact = after(20000);
  const double coarse = (after(50) - exact).norm(), fine = (after(100) - exact).norm();
  EXPECT_NEAR(coarse / fine, 4.0, 0.1);
}

TEST(RigidBody, AForceAtItsSideTurnsIt) {
  const auto world =
      world_of(scene_text({body("{box: {size: [0.2, 0.2, 0.2]}}", "")}, "  damping: {rate: 0}\n"));
  AppliedForce push;
  push.point = {0.1, 0.1, 0.1};
  push.force = {0.0, 0.0, 2.0};
  push.duration = 0.1;
  world->applied_forces().add(push);
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(world->step());
  EXPECT_LT((rigid_of(*world).particles().momentum() - Eigen::Vector3d(0, 0, 0.2)).norm(), 1e-9);
  // The arm turns a little while it is pushed.
  const Eigen::Vector3d turned = 0.1 * Eigen::Vector3d(0.1, 0.1, 0.1).cross(push.force);
  EXPECT_LT((spin_of(*world) - turned).norm(), 0.02 * turned.norm());
}

class RigidSolver : public testing::TestWithParam<std::string> {};

TEST_P(RigidSolver, SlidesDownAnInclineByCoulombsLaw) {
  const double slope = 0.5, friction = 0.2, angle = std::atan(slope);
  const std::string gravity = fmt::format("  gravity: {{acceleration: [{}, 0, {}]}}\n",
                                          kGravity * std::sin(angle), -kGravity * std::cos(angle));
  const auto world = world_of(scene_text(
      {body("{box: {size: [0.1, 0.1, 0.04]}}", "position: [0, 0, 0.021]")},
      gravity + fmt::format("  contact: {{}}\n  friction: {{coefficient: {}}}\n", friction),
      "obstacles: [{name: plane, shape: plane}]\nsolver: {name: " + GetParam() + "}\n"));
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step());
  const double before = rigid_of(*world).particles().momentum().x();
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(world->step());
  const double gained = (rigid_of(*world).particles().momentum().x() - before) /
                        rigid_of(*world).mass() / (40 * world->time_step());
  const double expected = kGravity * (std::sin(angle) - friction * std::cos(angle));
  EXPECT_NEAR(gained, expected, 0.02 * expected);
}

TEST_P(RigidSolver, RestsWithoutCreepOrWeight) {
  const auto world = world_of(
      scene_text({body("{box: {size: [0.1, 0.08, 0.06]}}",
                       "position: [0, 0, 0.1], rotation_rpy: [0.3, 0.2, 0.1]")},
                 "  gravity: {}\n  contact: {}\n  friction: {}\n",
                 "obstacles: [{name: plane, shape: plane}]\nsolver: {name: " + GetParam() + "}\n"));
  const double before = world->energies().total();
  for (int k = 0; k < 300; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_LT(world->energies().total(), 1.01 * before) << k;
  }
  const Eigen::Vector3d at = rigid_of(*world).particles().center_of_mass();
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(world->step());
    const double weight = kGravity * rigid_of(*world).mass();
    EXPECT_NEAR(world->reactions().front().force.z(), -weight, 0.02 * weight);
  }
  EXPECT_LT((rigid_of(*world).particles().center_of_mass() - at).norm(), 5e-5);
}

INSTANTIATE_TEST_SUITE_P(Solvers, RigidSolver,
                         testing::Values("xpbd", "jacobi", "line_search_jacobi", "gauss_seidel",
                                         "hybrid", "chebyshev"),
                         [](const auto& info) { return info.param; });

TEST(RigidBody, IsHeldWhereItsSurfaceIsGripped) {
  const auto world = world_of(
      scene_text({body("{box: {size: [0.1, 0.1, 0.1]}}",
                       "attachments: [{name: hold, sphere: {center: [0.05, 0.05, 0.05], radius: "
                       "0.01}, to: world, stiffness: 1.0e+5}]")},
                 "  gravity: {}\n"));
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(world->step());
  EXPECT_LT(rigid_of(*world).particles().center_of_mass().norm(), 1e-3);
}

}  // namespace
}  // namespace pliant::rigid_body_test
