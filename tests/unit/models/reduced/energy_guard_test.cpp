#include "pliant/models/reduced/integrators/energy_guard.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

/// A step that changes an energy of 100 J by `change`.
EnergyChange step_of(double change) {
  EnergyChange step;
  step.before = 100.0;
  step.after = 100.0 + change;
  return step;
}

TEST(EnergyGuard, LeavesSwingsAlone) {
  EnergyGuard guard(0.05);
  for (int k = 0; k < 1000; ++k) {
    EXPECT_EQ(guard.take(step_of(std::cos(0.3 * k)), 50.0), 0.0) << k;
  }
}

TEST(EnergyGuard, TakesBackWhatErrorsSumUpToAndGivesWhatTheyLost) {
  for (const double sign : {1.0, -1.0}) {
    EnergyGuard guard(0.05);
    double taken = 0.0;
    for (int k = 0; k < 1000; ++k) taken += guard.take(step_of(sign * 0.1), 50.0);
    EXPECT_NEAR(taken, sign * 100.0, 5.1);  // all but what is allowed, 5 % of 100 J
  }
}

TEST(EnergyGuard, NeverTakesMoreThanAFiftiethOfTheKineticEnergyAtOnce) {
  EnergyGuard guard(0.05);
  EXPECT_DOUBLE_EQ(guard.take(step_of(300.0), 50.0), 1.0);
  EXPECT_EQ(guard.take(step_of(300.0), 0.0), 0.0);
}

TEST(EnergyGuard, WorkAndDampingAreNoErrors) {
  EnergyGuard guard(0.05);
  for (int k = 0; k < 1000; ++k) {
    EnergyChange step = step_of(0.5);
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
