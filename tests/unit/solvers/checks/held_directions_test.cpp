// The directions in which contact holds bodies: what is left of a velocity across them.
#include "pliant/solvers/checks/held_directions.h"

#include <gtest/gtest.h>

namespace pliant::held_directions_test {
namespace {

const Eigen::Vector3d kDrift(1.0, 2.0, 3.0);

/// Particles 0 and 1 are of piece 0, particle 2 of piece 1, and 3 is held.
const std::vector<int> kPieceOf = {0, 0, 1, -1};

class Contacts {
 public:
  void add(const std::vector<int>& particles, const Eigen::Vector3d& normal, double force = 1.0) {
    PointConstraint& constraint = constraints_.append();
    constraint.normal = normal.normalized();
    constraint.normal_force = force;
    for (const int particle : particles) constraints_.add(particle, 1.0);
  }
  HeldDirections held() {
    HeldDirections held;
    held.find(constraints_, kPieceOf, 2);
    return held;
  }

 private:
  PointConstraints constraints_;
};

TEST(HeldDirections, AnObstacleHoldsAlongItsNormalAlone) {
  Contacts contacts;
  contacts.add({0}, Eigen::Vector3d::UnitZ());
  contacts.add({1, 3}, Eigen::Vector3d(0.1, 0.0, 1.0));  // nearly the same
  const HeldDirections held = contacts.held();
  EXPECT_NEAR((held.open_part(0, kDrift) - Eigen::Vector3d(1, 2, 0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(held.open_part(1, kDrift), kDrift);
}

TEST(HeldDirections, SeveralNormalsHoldWhatTheySpan) {
  Contacts contacts;
  contacts.add({2}, Eigen::Vector3d::UnitZ());
  contacts.add({2}, Eigen::Vector3d(1, 0, 1));
  EXPECT_NEAR((contacts.held().open_part(1, kDrift) - Eigen::Vector3d(0, 2, 0)).norm(), 0.0, 1e-12);
  contacts.add({2}, Eigen::Vector3d(1, 1, 1));
  EXPECT_NEAR(contacts.held().open_part(1, kDrift).norm(), 0.0, 1e-12);
}

TEST(HeldDirections, AnotherPieceGivesWay) {
  Contacts contacts;
  contacts.add({0, 2}, Eigen::Vector3d::UnitZ());
  const HeldDirections held = contacts.held();
  EXPECT_EQ(held.open_part(0, kDrift), kDrift);
  EXPECT_EQ(held.open_part(1, kDrift), kDrift);
}

TEST(HeldDirections, NothingHoldsThatCarriesNoForce) {
  Contacts contacts;
  contacts.add({0}, Eigen::Vector3d::UnitZ(), 0.0);
  EXPECT_EQ(contacts.held().open_part(0, kDrift), kDrift);
}

TEST(HeldDirections, FingersGripFromOppositeSides) {
  Contacts groove, grip;
  groove.add({0}, Eigen::Vector3d(1, 0, 1));
  groove.add({1}, Eigen::Vector3d(-1, 0, 1));
  groove.add({2}, Eigen::Vector3d::UnitX());
  EXPECT_FALSE(groove.held().is_gripped(0));
  grip.add({0}, Eigen::Vector3d(1, 0, 0.1));
  grip.add({1}, Eigen::Vector3d(-1, 0, 0.1));
  grip.add({2}, Eigen::Vector3d::UnitX());
  EXPECT_TRUE(grip.held().is_gripped(0));
  EXPECT_FALSE(grip.held().is_gripped(1));
  HeldDirections none = grip.held();
  none.clear();
  EXPECT_FALSE(none.is_gripped(0));
}

}  // namespace
}  // namespace pliant::held_directions_test
