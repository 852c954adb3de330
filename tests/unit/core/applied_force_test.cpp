#include "pliant/core/body/applied_force.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"
#include "support/solvers/system_model.h"

namespace pliant {
namespace {

constexpr double kDt = 0.01;

/// Four particles of 1, 2, 3, 4 kg at x = 0, 1, 2, 3 m.
std::unique_ptr<World> row_of_four() {
  Positions x = Positions::Zero(3, 4);
  x.row(0) << 0, 1, 2, 3;
  return world_of(std::make_unique<SystemModel>(x, Eigen::Vector4d(1, 2, 3, 4)), kDt, "verlet");
}

AppliedForce push(double radius, double start, double duration) {
  AppliedForce force;
  force.point = Eigen::Vector3d(1, 0, 0);
  force.radius = radius;
  force.force = Eigen::Vector3d(0, 0, 6);
  force.start = start;
  force.duration = duration;
  return force;
}

Particles& particles(World& world) { return world.bodies().front().particles(); }

/// Steps in which the force acted, of `steps`.
int active_steps(World& world, int steps) {
  int active = 0;
  for (int k = 0; k < steps; ++k) {
    const double before = particles(world).momentum().z();
    EXPECT_TRUE(world.step());
    active += particles(world).momentum().z() > before + 1e-9;
  }
  return active;
}

TEST(AppliedForce, IsSharedByMassWithinTheRadius) {
  auto world = row_of_four();
  world->applied_forces().add(push(1.0, 0.0, 0.0));
  ASSERT_TRUE(world->step());
  // 6 N on 1 + 2 + 3 kg: each of them gets 1 m/s².
  for (int i : {0, 1, 2}) EXPECT_NEAR(particles(*world).v(2, i), kDt, 1e-15);
  EXPECT_EQ(particles(*world).v(2, 3), 0.0);
}

TEST(AppliedForce, RadiusZeroTakesTheNearestOne) {
  auto world = row_of_four();
  AppliedForce force = push(0.0, 0.0, 0.0);
  force.point = Eigen::Vector3d(1.6, 5, 0);
  world->applied_forces().add(force);
  ASSERT_TRUE(world->step());
  EXPECT_NEAR(particles(*world).v(2, 2), kDt * 6.0 / 3.0, 1e-15);
  for (int i : {0, 1, 3}) EXPECT_EQ(particles(*world).v(2, i), 0.0);
}

TEST(AppliedForce, AnEmptyRadiusTakesTheNearestOneToo) {
  auto world = row_of_four();
  AppliedForce force = push(0.1, 0.0, 0.0);
  force.point = Eigen::Vector3d(-3, 0, 0);
  world->applied_forces().add(force);
  ASSERT_TRUE(world->step());
  EXPECT_NEAR(particles(*world).v(2, 0), kDt * 6.0, 1e-15);
}

TEST(AppliedForce, FollowsItsParticles) {
  auto world = row_of_four();
  particles(*world).v.row(0).setConstant(100.0);
  world->applied_forces().add(push(0.2, 0.0, 5 * kDt));
  EXPECT_EQ(active_steps(*world, 8), 5);
  EXPECT_NEAR(particles(*world).v(2, 1), 5 * kDt * 3.0, 1e-13);
  EXPECT_EQ(particles(*world).v(2, 0), 0.0);
}

TEST(AppliedForce, ZeroDurationIsOneStep) {
  auto world = row_of_four();
  world->applied_forces().add(push(1.0, 0.0, 0.0));
  EXPECT_EQ(active_steps(*world, 5), 1);
  EXPECT_TRUE(world->applied_forces().empty());
}

TEST(AppliedForce, LastsItsWholeSteps) {
  for (const int steps : {1, 2, 3, 7, 30}) {
    auto world = row_of_four();
    world->applied_forces().add(push(1.0, 0.0, steps * kDt));
    EXPECT_EQ(active_steps(*world, 40), steps);
    EXPECT_TRUE(world->applied_forces().empty());
  }
}

TEST(AppliedForce, NegativeDurationIsForever) {
  auto world = row_of_four();
  world->applied_forces().add(push(1.0, 0.0, -1.0));
  EXPECT_EQ(active_steps(*world, 200), 200);
  world->applied_forces().clear();
  EXPECT_EQ(active_steps(*world, 5), 0);
}

TEST(AppliedForce, WaitsForItsStart) {
  auto world = row_of_four();
  world->applied_forces().add(push(1.0, 3 * kDt, 2 * kDt));
  EXPECT_EQ(active_steps(*world, 3), 0);
  EXPECT_EQ(active_steps(*world, 2), 2);
  EXPECT_EQ(active_steps(*world, 5), 0);
}

TEST(AppliedForce, AStartInThePastIsNow) {
  auto world = row_of_four();
  active_steps(*world, 10);
  world->applied_forces().add(push(1.0, -5.0, 4 * kDt));
  EXPECT_EQ(active_steps(*world, 10), 4);
}

/// Two particles, of 1 kg and of 2 kg.
World world_of_two_bodies() {
  World world(kDt);
  for (int b = 0; b < 2; ++b) {
    Body& body =
        world.add_body("b" + std::to_string(b),
                       std::make_unique<SystemModel>(Positions::Constant(3, 1, 0.1 * b), 1.0 + b));
    world.set_solver(body, solver_registry(), "verlet", {}, "test");
  }
  world.set_initial_state();
  return world;
}

TEST(AppliedForce, SpansBodies) {
  World world = world_of_two_bodies();
  AppliedForce force = push(1.0, 0.0, 0.0);
  force.point.setZero();
  world.applied_forces().add(force);
  ASSERT_TRUE(world.step());
  for (const Body& body : world.bodies()) EXPECT_NEAR(body.particles().v(2, 0), 2.0 * kDt, 1e-14);
}

TEST(AppliedForce, OnOneBodyLeavesTheOther) {
  for (const double radius : {1.0, 0.0}) {
    World world = world_of_two_bodies();
    AppliedForce force = push(radius, 0.0, -1.0);
    force.point.setZero();
    force.body = 1;
    world.applied_forces().add(force);
    ASSERT_TRUE(world.step());
    EXPECT_EQ(world.bodies()[0].particles().v(2, 0), 0.0) << "although it is the nearest";
    EXPECT_GT(world.bodies()[1].particles().v(2, 0), 0.0);
    EXPECT_EQ(world.applied_forces().clear(0), 0);
    EXPECT_EQ(world.applied_forces().clear(1), 1);
    EXPECT_TRUE(world.applied_forces().empty());
  }
}

TEST(AppliedForce, OnAFixedParticleMovesNothing) {
  auto world = row_of_four();
  particles(*world).fix(1);
  world->system_changed();
  world->applied_forces().add(push(0.0, 0.0, -1.0));
  const Positions before = particles(*world).x;
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(particles(*world).x, before);
}

TEST(AppliedForce, ResetClearsIt) {
  auto world = row_of_four();
  world->applied_forces().add(push(1.0, 0.0, -1.0));
  active_steps(*world, 3);
  world->reset();
  EXPECT_EQ(active_steps(*world, 3), 0);
}

TEST(AppliedForce, RefusesWhatIsNotFinite) {
  AppliedForces forces;
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    AppliedForce force = push(0.1, 0, 0);
    force.point.y() = bad;
    expect_refusal([&] { forces.add(force); }, {"apply_force", "'point'", "finite"});
    force = push(0.1, 0, 0);
    force.force.z() = bad;
    expect_refusal([&] { forces.add(force); }, {"apply_force", "'force'", "finite"});
    expect_refusal([&] { forces.add(push(bad, 0, 0)); }, {"apply_force", "'radius'", "finite"});
    expect_refusal([&] { forces.add(push(0.1, bad, 0)); }, {"apply_force", "'start'", "finite"});
    expect_refusal([&] { forces.add(push(0.1, 0, bad)); }, {"apply_force", "'duration'", "finite"});
  }
  expect_refusal([&] { forces.add(push(-0.1, 0, 0)); }, {"'radius'", "-0.1", ">= 0 [m]"});
  EXPECT_TRUE(forces.empty());
}

}  // namespace
}  // namespace pliant
