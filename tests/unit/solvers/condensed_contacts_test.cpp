#include "pliant/solvers/constrained/condensed_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pliant/solvers/constrained/contact_impulses.h"
#include "support/solvers/plain_constraint.h"

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
    components.twisted = {false};
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

/// A body of coordinates that shifts as a whole.
class ShiftingBody final : public RespondingSystem {
 public:
  ShiftingBody(double mass, const Eigen::Vector3d& velocity)
      : root_(std::sqrt(mass)), momenta_(root_ * velocity) {}
  void keep_open(bool) override {}
  void move(const Forces&, Positions&) override {}
  void respond(const std::vector<int>&, Eigen::Ref<Forces>) override {}
  double answer(int) override { return 0.0; }
  const Eigen::MatrixXd& inverse_response() override { return inverse_; }
  void close(double, double) override {}
  Eigen::VectorXd& momenta() override { return momenta_; }
  void add_rows(int, double weight, Eigen::Ref<Eigen::MatrixXd> rows) const override {
    rows += weight / root_ * Eigen::Matrix3d::Identity();
  }
  void take_impulses(const Eigen::VectorXd& impulses, double) override { taken = root_ * impulses; }
  Eigen::Vector3d velocity() const { return momenta_ / root_; }
  Eigen::Vector3d taken = Eigen::Vector3d::Zero();  // [N s]

 private:
  double root_;
  Eigen::VectorXd momenta_;
  Eigen::MatrixXd inverse_;
};

/// Particle 0 lies on particle 1, pressed against it.
class LiesOn final : public TellingConstraint {
 public:
  double friction = 0.0, pressing = 1e6;  // [1], [N]
  PointConstraint found;
  void add_point_constraints(const Positions&, PointConstraints& constraints) override {
    PointConstraint& point = constraints.append();
    point.normal = Eigen::Vector3d::UnitZ();
    point.friction = friction;
    point.normal_force = pressing;
    constraints.add(0, 1.0);
    constraints.add(1, -1.0);
  }
  void take_multipliers(const PointConstraints& constraints) override {
    found = constraints.all[0];
  }
};

/// A particle of 1 kg that falls onto a body of 3 kg, which rises; the particle slips on it.
struct Hit {
  explicit Hit(double friction, double pressing = 1e6) : body(3.0, {0.5, 0.0, 1.0}) {
    particles = Particles(Positions::Zero(3, 2), Eigen::Vector2d(1.0, 3.0));
    particles.fix(1);  // the body's own
    particles.v << 4.0, 0.0, 0.0, 0.0, -2.0, 0.0;
    constraint.friction = friction;
    constraint.pressing = pressing;
    ContactImpulses().apply({{1, 2, &body}}, {&constraint}, kDt, particles);
  }
  static constexpr double kDt = 0.01;
  ShiftingBody body;
  Particles particles;
  LiesOn constraint;
};

TEST(ContactImpulses, WhatSticksGoesOnTogetherWithAllTheMomentum) {
  const Hit hit(100.0);
  // (1 kg v₀ + 3 kg v₁)/4 kg.
  const Eigen::Vector3d together(5.5 / 4.0, 0.0, 1.0 / 4.0);
  EXPECT_LE((hit.particles.v.col(0) - together).norm(), 1e-7);
  EXPECT_LE((hit.body.velocity() - together).norm(), 1e-7);
  EXPECT_LE((hit.body.taken - 3.0 * (together - Eigen::Vector3d(0.5, 0.0, 1.0))).norm(), 1e-7);
}

TEST(ContactImpulses, WithoutFrictionTheSlipGoesOn) {
  const Hit hit(0.0);
  EXPECT_LE((hit.particles.v.col(0) - Eigen::Vector3d(4.0, 0.0, 0.25)).norm(), 1e-7);
  EXPECT_LE((hit.body.velocity() - Eigen::Vector3d(0.5, 0.0, 0.25)).norm(), 1e-7);
}

TEST(ContactImpulses, FrictionIsBoundedByAllThatPresses) {
  // What stops the fall is 2.25 N s, beside the 1 N s of the step's force.
  const Hit hit(0.2, 1.0 / Hit::kDt);
  const double slowed = 0.2 * (2.25 + 1.0);
  EXPECT_LE((hit.particles.v.col(0) - Eigen::Vector3d(4.0 - slowed, 0.0, 0.25)).norm(), 1e-7);
  EXPECT_LE((hit.body.velocity() - Eigen::Vector3d(0.5 + slowed / 3.0, 0.0, 0.25)).norm(), 1e-7);
  EXPECT_NEAR(hit.constraint.found.normal_force, (2.25 + 1.0) / Hit::kDt, 1e-5);
  EXPECT_NEAR(hit.constraint.found.friction_force.x(), -slowed / Hit::kDt, 1e-5);
}

}  // namespace
}  // namespace pliant::condensed_contacts_test
