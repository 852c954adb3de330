// Momentum and invariance of sets that act between particles alone.
#include <gtest/gtest.h>

#include "unit/elements/element_fixture.h"

namespace pliant {
namespace {

template <class Set>
class AnInternalElementSet : public AnElementSet<Set> {};

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
