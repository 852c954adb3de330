#include "pliant/solvers/constrained/condensed_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pliant::condensed_contacts_test {
namespace {

constexpr double kForce = 8.0;  // on the block, towards the plane [N]

/// A block of eight vertices of 1 kg each, with dt = 1 s, on a plane that its four lower vertices
/// touch, pushed down and along by forces on its centre.
class Block {
 public:
  explicit Block(double along, double down = kForce) {
    x_.resize(3, 8);
    for (int i = 0; i < 8; ++i) {
      x_.col(i) = Eigen::Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.2 : 0.0);
    }
    Components components;
    for (int i = 0; i < 8; ++i) components.members.push_back(i);
    components.begins = {0, 8};
    components.held = {false};
    const Eigen::VectorXd inertia = Eigen::VectorXd::Ones(8);
    modes_.prepare(components, inertia);
    modes_.update(x_);
    sums_ = Eigen::VectorXd::Zero(6);
    sums_ << along, 0.0, -down, 0.0, 0.0, 0.0;
  }

  void solve(double friction, double compliance = 1e-3) {
    contacts_.begin(sums_);
    for (int i = 0; i < 4; ++i) {
      PointConstraint constraint;
      constraint.normal = Eigen::Vector3d::UnitZ();
      constraint.friction = friction;
      contacts_.append(constraint, compliance);
      contacts_.add(modes_, i, 1.0);
    }
    contacts_.solve(modes_);
  }

  double normal() const {
    double sum = 0.0;
    for (std::size_t c = 0; c < 4; ++c) sum += contacts_.normal_force(c);
    return sum;
  }
  Eigen::Vector3d tangential() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < 4; ++c) sum += contacts_.friction_force(c);
    return sum;
  }
  const CondensedContacts& contacts() const { return contacts_; }
  /// What the law of momentum is missed by, of all six sums.
  double missed() const {
    Eigen::Matrix<double, 6, 1> sum = sums_;
    for (int i = 0; i < 4; ++i) {
      const auto c = static_cast<std::size_t>(i);
      sum += modes_.project(
          i, contacts_.normal_force(c) * Eigen::Vector3d::UnitZ() + contacts_.friction_force(c));
    }
    return (modes_.inertia(0) * contacts_.motions() - sum).norm();
  }

 private:
  Positions x_;
  RigidModes modes_;
  Eigen::VectorXd sums_;
  CondensedContacts contacts_;
};

TEST(CondensedContacts, CarryTheWeight) {
  Block block(0.0);
  block.solve(0.5);
  // Four contacts share it, each compliant by a thousandth of 1 m/N; what they give way takes 8 kg
  // along.
  const double normal = kForce / (1.0 + 8.0 * 1e-3 / 4.0);
  EXPECT_NEAR(block.normal(), normal, 1e-5 * kForce);
  EXPECT_NEAR(block.contacts().motions()[2], -1e-3 * normal / 4.0, 1e-5 * kForce / 4.0);
  EXPECT_LE(block.missed(), 1e-12);
}

TEST(CondensedContacts, StickBelowTheAngleOfFriction) {
  Block block(0.45 * kForce);
  block.solve(0.5);
  EXPECT_NEAR(block.tangential().x(), -0.45 * kForce, 2e-3 * kForce);
  EXPECT_LE(std::abs(block.contacts().motions()[0]), 1e-2);
}

TEST(CondensedContacts, SlideAboveIt) {
  Block block(0.8 * kForce);
  block.solve(0.5);
  EXPECT_NEAR(block.tangential().x(), -0.5 * block.normal(), 1e-6 * kForce);
  // (0.8 - 0.5) of the force over 8 kg.
  EXPECT_NEAR(block.contacts().motions()[0], 0.3 * kForce / 8.0, 1e-2 * kForce / 8.0);
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_LE(block.contacts().friction_force(c).norm(),
              0.5 * block.contacts().normal_force(c) * (1.0 + 1e-12));
  }
}

TEST(CondensedContacts, PullNothing) {
  Block block(0.0, -kForce);
  block.solve(0.5);
  EXPECT_EQ(block.normal(), 0.0);
  EXPECT_NEAR(block.contacts().motions()[2], kForce / 8.0, 1e-12);
}

// However badly it begins, and wherever it stops, forces are such as may be and the momentum is
// theirs.
TEST(CondensedContacts, AreAdmissibleFromAnyBeginning) {
  Block block(3.0 * kForce);
  block.solve(1.5, 1e-9);
  EXPECT_LE(block.missed(), 1e-9 * kForce);
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_GE(block.contacts().normal_force(c), 0.0);
    EXPECT_LE(block.contacts().friction_force(c).norm(),
              1.5 * block.contacts().normal_force(c) * (1.0 + 1e-12));
  }
}

}  // namespace
}  // namespace pliant::condensed_contacts_test
