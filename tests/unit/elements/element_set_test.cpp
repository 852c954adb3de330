// What every kind of element set has to fulfil: energy, forces, matrices.
#include "pliant/core/system/element_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "unit/elements/element_fixture.h"

namespace pliant {
namespace {

TYPED_TEST_SUITE(AnElementSet, AllSets, NameOfSet);

TYPED_TEST(AnElementSet, ForceIsMinusTheGradientOfEnergy) {
  const Positions x = this->crumpled();
  const Forces f = this->forces(x);
  const double scale = f.cwiseAbs().maxCoeff();
  const double h = 1e-6;
  for (int k = 0; k < x.size(); ++k) {
    Positions up = x, down = x;
    up.data()[k] += h;
    down.data()[k] -= h;
    const double slope = (this->set_->energy(up) - this->set_->energy(down)) / (2.0 * h);
    // Central differences: E''' h² / 6, with lengths of 0.1 m about 1e-10 of the force, and the
    // round-off of the energy over h, about 1e-16 E / h.
    ASSERT_NEAR(f.data()[k], -slope, 1e-7 * scale + 1e-16 * this->set_->energy(x) / h);
  }
}

TYPED_TEST(AnElementSet, StiffnessIsMinusTheGradientOfForce) {
  const Positions x = this->crumpled();
  const Eigen::MatrixXd k = stiffness_of(*this->set_, x);
  const Eigen::MatrixXd differences = stiffness_by_differences(*this->set_, x, 1e-6);
  // As above, one order lower.
  EXPECT_LE((k - differences).cwiseAbs().maxCoeff(), 1e-7 * k.cwiseAbs().maxCoeff());
  EXPECT_LE((k - k.transpose()).cwiseAbs().maxCoeff(), 1e-12 * k.cwiseAbs().maxCoeff());
}

TYPED_TEST(AnElementSet, ProjectedStiffnessLiesBetweenTheExactOneAndTheSystemMatrix) {
  for (int trial = 0; trial < 10; ++trial) {
    const Positions x = this->crumpled();
    const Eigen::MatrixXd exact = stiffness_of(*this->set_, x);
    const Eigen::MatrixXd projected = stiffness_of(*this->set_, x, Definiteness::kProjected);
    const Eigen::MatrixXd bound = over_coordinates(system_of(*this->set_, this->n_));
    const double round_off = 1e-12 * bound.norm();
    EXPECT_GE(least_eigenvalue(projected), -round_off);
    EXPECT_GE(least_eigenvalue(projected - exact), -round_off);
    EXPECT_GE(least_eigenvalue(bound - projected), -round_off);
  }
}

TYPED_TEST(AnElementSet, InStretchProjectionChangesNothing) {
  // A volume that resists growth does not resist changing its shape: it has no such state.
  if (this->set_->name() == "volume") return;
  const Positions x = 1.2 * this->rest_;
  const Eigen::MatrixXd exact = stiffness_of(*this->set_, x);
  const Eigen::MatrixXd projected = stiffness_of(*this->set_, x, Definiteness::kProjected);
  EXPECT_LE((projected - exact).norm(), 1e-11 * exact.norm());
}

TYPED_TEST(AnElementSet, RestHasNoEnergy) {
  EXPECT_NEAR(this->set_->energy(this->rest_), 0.0, 1e-25);
  EXPECT_LE(this->forces(this->rest_).norm(), 1e-11);
}

TYPED_TEST(AnElementSet, SystemMatrixIsSymmetricAndSemidefinite) {
  const Eigen::MatrixXd a = system_of(*this->set_, this->n_);
  EXPECT_LE((a - a.transpose()).norm(), 1e-15 * a.norm());
  EXPECT_GE(least_eigenvalue(a), -1e-12 * a.norm());
}

TYPED_TEST(AnElementSet, SystemMatrixBoundsTheEnergy) {
  // E(x + d) <= E(x) - f . d + 1/2 d A d: what makes projective steps safe.
  const Eigen::MatrixXd a = system_of(*this->set_, this->n_);
  for (int trial = 0; trial < 200; ++trial) {
    const Positions x = this->crumpled();
    // Half of these turn elements inside out.
    const Positions d = this->random_.positions(this->n_, trial % 2 == 0 ? 0.05 : 0.5);
    const double energy = this->set_->energy(x);
    const double linear = -this->forces(x).cwiseProduct(d).sum();
    const double quadratic = 0.5 * (d * a).cwiseProduct(d).sum();
    EXPECT_LE(this->set_->energy(x + d), (energy + linear + quadratic) * (1.0 + 1e-12));
  }
}

TYPED_TEST(AnElementSet, RowSumsBoundTheSystemMatrix) {
  const Eigen::MatrixXd a = system_of(*this->set_, this->n_);
  AbsoluteRowSums rows(this->n_);
  this->set_->add_to_system(rows);
  const Eigen::MatrixXd gap = Eigen::MatrixXd(rows.sums().asDiagonal()) - a;
  EXPECT_GE(least_eigenvalue(gap), -1e-12 * a.norm());
}

TYPED_TEST(AnElementSet, AddsToForcesThatAreThere) {
  const Positions x = this->crumpled();
  Forces f = Forces::Constant(3, x.cols(), 5.0);
  this->set_->add_forces(x, f);
  EXPECT_LE((f.array() - 5.0 - this->forces(x).array()).abs().maxCoeff(), 1e-12);
}

TYPED_TEST(AnElementSet, NonFinitePositionsLeaveNoTrace) {
  const Positions x = this->crumpled();
  const Forces before = this->forces(x);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
    const Positions wrong = Positions::Constant(3, this->n_, bad);
    this->forces(wrong);
    this->set_->energy(wrong);
    Positions moved = wrong;
    this->set_->relax(Eigen::VectorXd::Constant(this->n_, 1e3), 1e-3, moved);
    EXPECT_EQ(this->forces(x), before);
  }
}

TYPED_TEST(AnElementSet, SavedStateGoesOnBitForBit) {
  const auto results = [&](ElementSet& set) {
    // Crushed to a point: what was before decides.
    const Positions crushed = this->rest_.rowwise().mean().replicate(1, this->n_);
    Positions x(3, 2 * this->n_);
    x << forces_of(set, crushed), forces_of(set, this->rest_);
    return x;
  };
  const Positions before = this->crumpled();
  this->forces(-before);
  StateArchive saved;
  this->set_->save(saved);
  const Positions expected = results(*this->set_);
  this->forces(before);
  ElementExample twin = make_example<TypeParam>(3);
  for (ElementSet* set : {this->set_.get(), twin.set.get()}) {
    saved.rewind();
    set->load(saved);
    EXPECT_EQ(results(*set), expected);
  }
  EXPECT_TRUE(std::isnan(saved.read()));
}

}  // namespace
}  // namespace pliant
