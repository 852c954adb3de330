// Momentum of bodies that touch, with iterations that end early: that of the forces, and a word
// where there are too many bodies for it.
#include "pliant/solvers/checks/momentum_balance.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pliant/effects/registry.h"
#include "support/measures.h"
#include "support/solvers/plain_constraint.h"
#include "support/solvers/system_model.h"
#include "support/worlds/worlds.h"

namespace pliant::momentum_balance_test {
namespace {

/// Rods of two vertices on a stiff spring each, `along` from the one on a floor that they touch.
std::unique_ptr<World> rods(int count, const std::string& solver, double height = 0.0009,
                            const Eigen::Vector3d& along = {0.0, 0.0, 0.1}) {
  Positions x(3, 2 * count);
  std::vector<Spring> springs;
  for (int k = 0; k < count; ++k) {
    x.col(2 * k) = Eigen::Vector3d(0.3 * k, 0.0, height);
    x.col(2 * k + 1) = x.col(2 * k) + along;
    springs.push_back({2 * k, 2 * k + 1, 0.1, 1e6});
  }
  auto world = std::make_unique<World>(0.005);
  world->add_obstacle(obstacle(Plane()));
  auto model = std::make_unique<SystemModel>(x, 0.1);
  model->add("stretch", springs);
  Body& body = world->add_body("rods", std::move(model));
  world->add_effect(body, effect_registry(), "gravity", {}, "test");
  world->add_effect(body, effect_registry(), "contact", {{"thickness", "0.001"}}, "test");
  world->set_solver(body, solver_registry(), solver, {{"iterations", "2"}}, "test");
  world->set_initial_state();
  return world;
}

// The floor feels the weight, and nothing is left in the velocities.
TEST(MomentumBalance, HoldsTheWeightOfStiffBodiesWithTwoIterations) {
  for (const char* solver : {"jacobi", "chebyshev", "gauss_seidel", "hybrid"}) {
    // More than one matrix is made for, too.
    for (const int count : {3, 30}) {
      SCOPED_TRACE(std::string(solver) + " " + std::to_string(count));
      const auto world = rods(count, solver);
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(world->step()) << world->failure();
      const double weight = 9.81 * particles_of(*world).mass.sum();
      EXPECT_NEAR(-world->reactions()[0].force.z(), weight, 1e-6 * weight);
      EXPECT_LE(particles_of(*world).v.colwise().norm().maxCoeff(), 1e-3);
    }
  }
}

/// Rods that lean, fall by gravity and turn over the end that touches the floor.
std::unique_ptr<World> leaning_rods(int count) {
  return rods(count, "jacobi", 0.0005, {0.06, 0.0, 0.08});
}

// Whether all are found in one matrix or, with more of them, in turns.
TEST(MomentumBalance, ManyRodsTurnOverAsOneDoes) {
  const auto one = leaning_rods(1), many = leaning_rods(30);
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(one->step() && many->step());
    const Positions& x = particles_of(*one).x;
    for (int rod = 0; rod < 30; ++rod) {
      const Eigen::Vector3d place(0.3 * rod, 0.0, 0.0);
      // What either leaves out of balance: far less than the quarter of a millimetre of
      // a step's fall.
      EXPECT_LE((particles_of(*many).x.col(2 * rod) - place - x.col(0)).norm(), 1e-6) << k;
      EXPECT_LE((particles_of(*many).x.col(2 * rod + 1) - place - x.col(1)).norm(), 1e-6) << k;
    }
  }
  EXPECT_GT(particles_of(*one).x(0, 1) - particles_of(*one).x(0, 0), 0.065) << "it turned";
}

// A free body that would gain energy keeps its shape instead, and what it has of momentum along a
// floor without friction.
TEST(MomentumBalance, WhatIsHeldBackFromGainingEnergyKeepsItsMomentum) {
  for (const double spin : {20.0, 200.0}) {  // [1/s]
    const auto world = leaning_rods(1);
    Particles& p = particles_of(*world);
    p.v.col(0) = Eigen::Vector3d(1.0 - 0.04 * spin, 0.0, -1.0 + 0.03 * spin);
    p.v.col(1) = Eigen::Vector3d(1.0 + 0.04 * spin, 0.0, -1.0 - 0.03 * spin);
    bool is_held_back = false;
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(world->step()) << world->failure();
      is_held_back = is_held_back || warns(*world, "energy_held_back");
      EXPECT_NEAR(p.momentum().x(), 0.2, 1e-9) << spin << " " << k;  // 0.2 kg at 1 m/s
    }
    EXPECT_TRUE(is_held_back) << spin;
  }
}

/// Tells nothing of what it does.
class SilentConstraint final : public PlainConstraint {
 public:
  bool is_idle() const override { return idle; }
  bool idle = false;
};

TEST(MomentumBalance, BodiesMoveRigidlyWhereAllThatActsOnThemIsTold) {
  Positions x = Positions::Zero(3, 2);
  x(0, 1) = 1.0;
  SystemModel model(x);
  model.add("stretch", {{0, 1, 1.0, 100.0}});
  auto& system = static_cast<ProjectiveSystem&>(model.system());
  MomentumBalance balance;
  balance.prepare(system, 0.01);
  EXPECT_TRUE(balance.can_move_rigidly(system));
  SilentConstraint constraint;
  system.constraints = {&constraint};
  EXPECT_FALSE(balance.can_move_rigidly(system));
  constraint.idle = true;
  EXPECT_TRUE(balance.can_move_rigidly(system));
  system.responders = {{0, 1, nullptr}};
  EXPECT_FALSE(balance.can_move_rigidly(system));
  system.responders.clear();
  model.particles().fix(0);
  balance.prepare(system, 0.01);
  EXPECT_FALSE(balance.can_move_rigidly(system)) << "nothing is free";
}

}  // namespace
}  // namespace pliant::momentum_balance_test
