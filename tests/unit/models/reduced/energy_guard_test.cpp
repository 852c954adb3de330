#include "pliant/models/reduced/integrators/energy_guard.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace pliant
