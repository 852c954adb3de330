#include "pliant/models/reduced/integrators/energy_guard.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/models/reduced/step_balance.h"

namespace pliant {
namespace {

/// A step that changes an energy of 100 J by `change`, the one after the step before.
EnergyChange step_of(double change) {
  EnergyChange step;
  step.before = 100.0;
  step.after = 100.0 + change;
  return step;
}

/// The next step of a body that nothing else moves.
struct Alone {
  double energy = 100.0;
  EnergyChange step(double change, double taken = 0.0) {
    EnergyChange made;
    made.before = energy - taken;
    made.after = energy = made.before + change;
    return made;
  }
};

TEST(EnergyGuard, LeavesSwingsAlone) {
  EnergyGuard guard(0.05);
  Alone body;
  for (int k = 0; k < 1000; ++k) {
    EXPECT_EQ(guard.take(body.step(std::cos(0.3 * k)), 50.0), 0.0) << k;
  }
}

TEST(EnergyGuard, TakesBackWhatErrorsSumUpToAndGivesWhatTheyLost) {
  for (const double sign : {1.0, -1.0}) {
    EnergyGuard guard(0.05);
    Alone body;
    double taken = 0.0, last = 0.0;
    for (int k = 0; k < 1000; ++k) {
      last = guard.take(body.step(sign * 0.1, last), 50.0);
      taken += last;
    }
    EXPECT_NEAR(taken, sign * 100.0, 5.6);  // all but what is allowed, 5 % of the energy
  }
}

TEST(EnergyGuard, ForgetsWhereOthersChangeTheState) {
  // Each step begins at 100 J again: contact took what the step before had gained.
  EnergyGuard guard(0.05);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(guard.take(step_of(0.4), 50.0), 0.0);
  EXPECT_GT(guard.take(step_of(2.0), 50.0), 0.0);
}

TEST(EnergyGuard, NeverTakesMoreThanAFiftiethOfTheKineticEnergyAtOnce) {
  EnergyGuard guard(0.05);
  EXPECT_DOUBLE_EQ(guard.take(step_of(300.0), 50.0), 1.0);
  EXPECT_EQ(guard.take(step_of(300.0), 0.0), 0.0);
}

TEST(EnergyGuard, WorkAndDampingAreNoErrors) {
  EnergyGuard guard(0.05);
  Alone body;
  for (int k = 0; k < 1000; ++k) {
    EnergyChange step = body.step(0.5);
    step.work = 0.8;
    step.dissipated = 0.3;
    EXPECT_EQ(guard.take(step, 50.0), 0.0);
  }
}

TEST(EnergyGuard, DampingLeavesThePastBehind) {
  // An error of 4 J is none of a body that has come to rest at 1 J.
  EnergyGuard guard(0.05);
  EXPECT_EQ(guard.take(step_of(4.0), 50.0), 0.0);
  double energy = 104.0;
  while (energy > 1.0) {
    EnergyChange step;
    step.before = energy;
    step.dissipated = 0.01 * energy;
    step.after = energy -= step.dissipated;
    EXPECT_EQ(guard.take(step, 0.5 * energy), 0.0) << energy;
  }
}

/// One coordinate on a spring of 4 N/m, at q = 1 with p = 4: 2 J and 8 J.
ReducedSystem spring_of_one_coordinate() {
  ReducedSystem system(
      QuarticPotential(Eigen::VectorXd::Constant(1, 4.0), {0.0, 0.0}, "StepBalance"));
  system.q = Eigen::VectorXd::Constant(1, 1.0);
  system.p = Eigen::VectorXd::Constant(1, 4.0);
  system.force = Eigen::VectorXd::Zero(1);
  return system;
}

TEST(StepBalance, WhatTheOthersForcesDidIsNoGain) {
  ReducedSystem system = spring_of_one_coordinate();
  StepBalance balance;
  balance.begin(system);
  EXPECT_EQ(balance.end(system), 0.0);
  // To q = 2: 8 J and 8 J, so 6 J more, the work of 6 N on the path of one.
  system.q[0] = 2.0;
  EXPECT_TRUE(balance.has_to_compare(system));
  EXPECT_EQ(balance.close(system, Eigen::VectorXd::Constant(1, 6.0)), 0.0);
  EXPECT_EQ(system.p[0], 4.0);
}

TEST(StepBalance, WhatNoForceDidIsTakenFromTheMomentum) {
  ReducedSystem system = spring_of_one_coordinate();
  StepBalance balance;
  balance.begin(system);
  balance.end(system);
  // 36 J where there were 10 J and 6 J of work: 20 J, more than half, are to be taken from 28 J.
  system.q[0] = 2.0;
  system.p[0] = std::sqrt(56.0);
  EXPECT_NEAR(balance.close(system, Eigen::VectorXd::Constant(1, 6.0)), 20.0, 1e-12);
  EXPECT_NEAR(system.p[0], 4.0, 1e-12);
}

/// A step at whose end contact takes it from 2 J to 200 J without a force, all of it elastic.
void crush(ReducedSystem& system, StepBalance& balance) {
  system.p[0] = 0.0;
  balance.begin(system);
  balance.end(system);
  system.q[0] = 10.0;
  EXPECT_EQ(balance.close(system, Eigen::VectorXd::Zero(1)), 0.0);
}

TEST(StepBalance, WhatTheMomentumDoesNotHoldIsTakenFromTheShapeInTheNextStep) {
  ReducedSystem system = spring_of_one_coordinate();
  StepBalance balance;
  crush(system, balance);
  // The next step begins there, so that its start is no way back.
  balance.begin(system);
  EXPECT_GT(balance.end(system), 0.0);
  EXPECT_LE(system.elastic_energy() + system.kinetic_energy(), 2.0 + 1e-12);
  EXPECT_GT(system.q[0], 0.0);
  // Contact moves it there again: that is no less of a gain.
  system.q[0] = 10.0;
  EXPECT_TRUE(balance.has_to_compare(system));
}

TEST(StepBalance, WhatTheShapeHeldBeforeIsLeftThere) {
  ReducedSystem system = spring_of_one_coordinate();
  system.p[0] = 0.0;
  StepBalance balance;
  for (int step = 0; step < 3; ++step) {
    balance.begin(system);
    // From 2 J to 8 J without a force, and no contact.
    system.q[0] = 2.0;
    EXPECT_GT(balance.end(system), 0.0) << step;
    EXPECT_LE(system.elastic_energy(), 2.0 + 1e-9) << step;
    EXPECT_NEAR(system.q[0], 1.0, 1e-9) << step;
  }
}

TEST(StepBalance, AStepThatIsUndoneTakesTheSameAgain) {
  ReducedSystem system = spring_of_one_coordinate();
  StepBalance balance;
  crush(system, balance);
  double taken[2];
  for (double& energy : taken) {
    system.q[0] = 10.0;
    balance.begin(system);
    energy = balance.end(system);
    EXPECT_LT(system.q[0], 1.1);
    balance.undo_step();
  }
  EXPECT_EQ(taken[0], taken[1]);
}

}  // namespace
}  // namespace pliant
