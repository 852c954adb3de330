// What every kind of element set has to fulfil, in one place.
#include "pliant/core/element_set.h"

#include <gtest/gtest.h>

#include <string>

#include "pliant/core/parallel.h"
#include "support/matrices.h"
#include "unit/elements/element_examples.h"

namespace pliant {
namespace {

template <class Set>
class AnElementSet : public testing::Test {
 protected:
  /// A state so far from rest that everything is strained, and so near that no spring is short and
  /// no tetrahedron inverted.
  Positions crumpled() { return rest_ + random_.positions(n_, 0.02); }
  Forces forces(const Positions& x) const { return forces_of(*set_, x); }

  Random random_{11};
  ElementExample example_ = make_example<Set>(3);
  Positions rest_ = example_.rest;
  int n_ = static_cast<int>(rest_.cols());
  std::unique_ptr<ElementSet>& set_ = example_.set;
};

struct NameOfSet {
  template <class Set>
  static std::string GetName(int) {
    return std::string(make_example<Set>(2).set->name());
  }
};

using AllSets = testing::Types<SpringSet, BendingSet, TetrahedronSet, VolumeSet, StrainLimitSet,
                               TriangleStrainSet, ClusterSet, OrientedClusterSet, AttachmentSet>;
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

/// |m (x - y) / h² - f(x)| over |f(y)| after many sweeps from y: what is missing to implicit Euler.
double missing_to_implicit_euler(ElementSet& set, const Positions& y, double dt) {
  const double mass = 1e-3;
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(y.cols(), 1.0 / mass);
  Positions x = y;
  set.reset_multipliers();
  for (int sweep = 0; sweep < 4000; ++sweep) set.relax(inverse_mass, dt, x);
  const Forces before = forces_of(set, y), after = forces_of(set, x);
  return (mass / (dt * dt) * (x - y) - after).norm() / before.norm();
}

TYPED_TEST(AnElementSet, RelaxConvergesToImplicitEuler) {
  // XPBD leaves out how the directions of springs turn while it iterates; displacements grow as h²,
  // so the error must fall with h² once they are small against a spring (none at all where
  // constraints are linear).
  const Positions y = this->crumpled();
  const double coarse = missing_to_implicit_euler(*this->set_, y, 2e-4);
  const double fine = missing_to_implicit_euler(*this->set_, y, 1e-4);
  EXPECT_LE(coarse, this->set_->name() == "stretch" ? 0.01 : 1e-9);
  EXPECT_LE(fine, coarse / 3.0 + 1e-9);
}

TYPED_TEST(AnElementSet, RelaxLowersTheEnergy) {
  // Not each sweep, since the later ones know what the earlier ones held, but from start to end.
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(this->n_, 1e3);
  for (const double dt : {1e-5, 1e-3, 1.0}) {
    const Positions y = this->crumpled();
    Positions x = y;
    this->set_->reset_multipliers();
    for (int sweep = 0; sweep < 20; ++sweep) this->set_->relax(inverse_mass, dt, x);
    EXPECT_LT(this->set_->energy(x), this->set_->energy(y)) << dt;
  }
}

TYPED_TEST(AnElementSet, RelaxLeavesFixedParticles) {
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(this->n_, 1e3);
  inverse_mass[3] = 0.0;
  const Positions y = this->crumpled();
  Positions x = y;
  this->set_->reset_multipliers();
  this->set_->relax(inverse_mass, 2e-3, x);
  EXPECT_EQ(x.col(3), y.col(3));
  inverse_mass.setZero();
  x = y;
  this->set_->relax(inverse_mass, 2e-3, x);
  EXPECT_EQ(x, y);
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

/// Forces and a few sweeps on `threads`.
template <class Set>
Positions all_results(int thread_count) {
  set_threads(thread_count);
  ElementExample example = make_example<Set>(40);
  const int n = static_cast<int>(example.rest.cols());
  Random random(3);
  const Positions x = example.rest + random.positions(n, 0.02);
  Positions relaxed = x;
  example.set->reset_multipliers();
  for (int k = 0; k < 2; ++k) {
    example.set->relax(Eigen::VectorXd::Constant(n, 1e3), 1e-3, relaxed);
  }
  Positions results(3, 2 * n + 1);
  results << forces_of(*example.set, x), relaxed,
      Eigen::Vector3d::Constant(example.set->energy(relaxed));
  set_threads(1);
  return results;
}

TYPED_TEST(AnElementSet, ThreadsDoNotChangeABit) {
  const Positions one = all_results<TypeParam>(1);
  EXPECT_TRUE(one == all_results<TypeParam>(2));
  EXPECT_TRUE(one == all_results<TypeParam>(4));
}

// Sets that act between particles alone: no attachments. Oriented particles have the other half of
// the angular momentum, see oriented_cluster_set_test.cpp.
template <class Set>
class AnInternalElementSet : public AnElementSet<Set> {};

using InternalSets = testing::Types<SpringSet, BendingSet, TetrahedronSet, VolumeSet,
                                    StrainLimitSet, TriangleStrainSet, ClusterSet>;
TYPED_TEST_SUITE(AnInternalElementSet, InternalSets, NameOfSet);

TYPED_TEST(AnInternalElementSet, ForcesHoldNoMomentum) {
  for (int trial = 0; trial < 20; ++trial) {
    const Positions x = this->crumpled();
    const Forces f = this->forces(x);
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();
    for (int i = 0; i < x.cols(); ++i) torque += x.col(i).cross(f.col(i));
    // Round-off of sums of about 30 terms.
    const double scale = f.colwise().norm().sum();
    EXPECT_LE(f.rowwise().sum().norm(), 1e-13 * scale);
    EXPECT_LE(torque.norm(), 1e-13 * scale);
  }
}

TYPED_TEST(AnInternalElementSet, RelaxKeepsMomentum) {
  const Positions y = this->crumpled();
  Eigen::VectorXd inverse_mass(this->n_);
  for (int i = 0; i < this->n_; ++i) inverse_mass[i] = this->random_(1.0, 2000.0);
  Positions x = y;
  this->set_->reset_multipliers();
  for (int sweep = 0; sweep < 5; ++sweep) this->set_->relax(inverse_mass, 2e-3, x);
  const Eigen::VectorXd mass = inverse_mass.cwiseInverse();
  EXPECT_LE(((x - y) * mass).norm(), 1e-14 * mass.sum());
}

TYPED_TEST(AnInternalElementSet, RigidMotionTurnsForces) {
  const Positions x = this->crumpled();
  const double energy = this->set_->energy(x);
  ASSERT_GT(energy, 0.0);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Matrix3d rotation = this->random_.rotation();
    const Eigen::Vector3d shift = this->random_.vector(3.0);
    const Positions moved = (rotation * x).colwise() + shift;
    // Positions of 3 m carry 4e-16 m of rounding; strains of 0.1 over 0.1 m lengths magnify that
    // to 1e-13 of the energy per element.
    EXPECT_NEAR(this->set_->energy(moved), energy, 1e-11 * energy);
    EXPECT_LE((this->forces(moved) - rotation * this->forces(x)).norm(),
              1e-11 * this->forces(x).norm());
  }
}

TYPED_TEST(AnInternalElementSet, AKilometreAwayNothingChangesButRoundOff) {
  const Eigen::Vector3d away(1000.0, -1000.0, 1000.0);
  const Positions x = this->crumpled();
  const Positions moved = x.colwise() + away;
  // Positions are rounded to 1e-13 m there: 1e-11 of a displacement of 0.01 m. Bending multiplies
  // by the square of the curvature's weights.
  EXPECT_LE((this->forces(moved) - this->forces(x)).norm(), 1e-10 * this->forces(x).norm());
  EXPECT_NEAR(this->set_->energy(moved), this->set_->energy(x), 1e-10 * this->set_->energy(x));
  Positions near = x, far = moved;
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(this->n_, 1e3);
  this->set_->reset_multipliers();
  this->set_->relax(inverse_mass, 1e-3, near);
  this->set_->reset_multipliers();
  this->set_->relax(inverse_mass, 1e-3, far);
  EXPECT_LE(((far.colwise() - away) - near).norm(), 1e-10);
}

TYPED_TEST(AnInternalElementSet, AShiftCostsTheSystemMatrixNothing) {
  const Eigen::MatrixXd a = system_of(*this->set_, this->n_);
  EXPECT_LE((a * Eigen::VectorXd::Ones(this->n_)).norm(), 1e-12 * a.norm());
}

}  // namespace
}  // namespace pliant
