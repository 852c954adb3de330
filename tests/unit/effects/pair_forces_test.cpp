// Forces of pairs from one step to the next.
#include "pliant/effects/contact/pair_forces.h"

#include <gtest/gtest.h>

namespace pliant::pair_forces_test {
namespace {

PairContact contact(const PairContact::Simplices& pair, double force) {
  PairContact result;
  result.simplices = pair;
  result.normal_force = force;
  result.friction_force = {0.1 * force, 0.0, 0.0};
  return result;
}

constexpr PairContact::Simplices kOne = {0, 1, 2, 3, 4}, kOther = {1, 1, 2, 3, 4};

TEST(PairForces, AreKnownByTheirSimplices) {
  PairForces forces;
  EXPECT_EQ(forces.find(kOne), nullptr);
  forces.take({contact(kOther, 2.0), contact(kOne, 1.0)});
  ASSERT_NE(forces.find(kOne), nullptr);
  EXPECT_EQ(forces.find(kOne)->normal, 1.0);
  EXPECT_EQ(forces.find(kOther)->friction.x(), 0.2);
  EXPECT_EQ(forces.find({0, 1, 2, 3, 5}), nullptr);
}

TEST(PairForces, OfAPairThatWasFoundTwiceBothAct) {
  PairForces forces;
  forces.take({contact(kOne, 1.0), contact(kOther, 5.0), contact(kOne, 2.0)});
  EXPECT_EQ(forces.find(kOne)->normal, 3.0);
}

TEST(PairForces, FrictionOfAPairThatWasFoundTwiceAddsUpForThatPairAlone) {
  PairForces forces;
  PairContact first = contact(kOne, 1.0), second = contact(kOne, 2.0);
  first.friction_force = {0.5, 0.0, -1.0};
  second.friction_force = {0.25, 2.0, 0.0};
  forces.take({first, contact(kOther, 5.0), second});
  EXPECT_EQ(forces.find(kOne)->friction, Eigen::Vector3d(0.75, 2.0, -1.0));
  EXPECT_EQ(forces.find(kOther)->friction, Eigen::Vector3d(0.5, 0.0, 0.0));
}

TEST(PairForces, WhatCarriesNothingOrKnowsNoSimplicesIsForgotten) {
  PairForces forces;
  forces.take({contact(kOne, 0.0), contact(PairContact::kUnknown, 1.0)});
  EXPECT_EQ(forces.find(kOne), nullptr);
  EXPECT_EQ(forces.find(PairContact::kUnknown), nullptr);
}

TEST(PairForces, GoOnAfterALoad) {
  PairForces forces, loaded;
  forces.take({contact(kOther, 2.0), contact(kOne, 1.0)});
  StateArchive numbers;
  forces.save(numbers);
  loaded.load(numbers);
  ASSERT_NE(loaded.find(kOther), nullptr);
  EXPECT_EQ(loaded.find(kOther)->normal, 2.0);
  EXPECT_EQ(loaded.find(kOther)->friction, forces.find(kOther)->friction);
}

}  // namespace
}  // namespace pliant::pair_forces_test
