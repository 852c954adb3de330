// What every kind of element set has to fulfil, in one place.
#include "pliant/core/element_set.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>

#include "pliant/elements/bending_set.h"
#include "pliant/elements/spring_set.h"
#include "pliant/models/cloth/cloth_springs.h"
#include "support/random.h"

namespace pliant {
namespace {

const GridOptions kGrid{0.5, 0.4, 6, 5};

template <class Set>
std::unique_ptr<ElementSet> make_set();

template <>
std::unique_ptr<ElementSet> make_set<SpringSet>() {
  std::vector<Spring> springs = grid_stretch_springs(kGrid, {300.0, 200.0, 0.0});
  const std::vector<Spring> shear = grid_shear_springs(kGrid, 50.0, 2);
  springs.insert(springs.end(), shear.begin(), shear.end());
  return std::make_unique<SpringSet>("stretch", springs, kGrid.columns * kGrid.rows);
}

template <>
std::unique_ptr<ElementSet> make_set<BendingSet>() {
  return std::make_unique<BendingSet>(make_grid(kGrid), 2e-3);
}

class DenseMatrix final : public SystemMatrix {
 public:
  explicit DenseMatrix(int n) : matrix(Eigen::MatrixXd::Zero(n, n)) {}
  void add(int row, int column, double stiffness) override { matrix(row, column) += stiffness; }
  Eigen::MatrixXd matrix;
};

template <class Set>
class AnElementSet : public testing::Test {
 protected:
  /// A crumpled state near rest, so that no spring is near zero length.
  Positions crumpled() {
    return make_grid(kGrid).vertices + random_.positions(kGrid.columns * kGrid.rows, 0.02);
  }
  Forces forces(const Positions& x) const {
    Forces f = Forces::Zero(3, x.cols());
    set_->add_forces(x, f);
    return f;
  }
  Random random_{11};
  std::unique_ptr<ElementSet> set_ = make_set<Set>();
};

using Sets = testing::Types<SpringSet, BendingSet>;
TYPED_TEST_SUITE(AnElementSet, Sets);

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

TYPED_TEST(AnElementSet, ForcesHoldNoMomentum) {
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

TYPED_TEST(AnElementSet, EnergyIsBlindToRigidMotion) {
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

TYPED_TEST(AnElementSet, RestHasNoEnergy) {
  const Positions rest = make_grid(kGrid).vertices;
  EXPECT_NEAR(this->set_->energy(rest), 0.0, 1e-25);
  EXPECT_LE(this->forces(rest).norm(), 1e-11);
}

TYPED_TEST(AnElementSet, SystemMatrixIsSymmetricAndSemidefinite) {
  DenseMatrix a(kGrid.columns * kGrid.rows);
  this->set_->add_to_system(a);
  EXPECT_EQ(a.matrix, a.matrix.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a.matrix);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-12 * eigen.eigenvalues().maxCoeff());
  // A shift costs nothing.
  EXPECT_LE((a.matrix * Eigen::VectorXd::Ones(a.matrix.rows())).norm(),
            1e-12 * a.matrix.norm());
}

TYPED_TEST(AnElementSet, SystemMatrixBoundsTheStiffness) {
  // E(x + d) <= E(x) - f . d + 1/2 d A d: what makes projective steps safe.
  DenseMatrix a(kGrid.columns * kGrid.rows);
  this->set_->add_to_system(a);
  for (int trial = 0; trial < 200; ++trial) {
    const Positions x = this->crumpled();
    const Positions d = this->random_.positions(static_cast<int>(x.cols()), 0.05);
    const double energy = this->set_->energy(x);
    const double linear = -this->forces(x).cwiseProduct(d).sum();
    const double quadratic = 0.5 * (d * a.matrix).cwiseProduct(d).sum();
    EXPECT_LE(this->set_->energy(x + d), (energy + linear + quadratic) * (1.0 + 1e-12));
  }
}

TYPED_TEST(AnElementSet, RowSumsBoundTheSystemMatrix) {
  const int n = kGrid.columns * kGrid.rows;
  DenseMatrix a(n);
  AbsoluteRowSums rows(n);
  this->set_->add_to_system(a);
  this->set_->add_to_system(rows);
  const Eigen::MatrixXd gap = Eigen::MatrixXd(rows.sums().asDiagonal()) - a.matrix;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gap);
  EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-12 * a.matrix.norm());
}

/// |m (x - y) / h² - f(x)| over |f(y)| after many sweeps from y: what is missing to implicit Euler.
double missing_to_implicit_euler(ElementSet& set, const Positions& y, double dt) {
  const double mass = 1e-3;
  const Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(y.cols(), 1.0 / mass);
  Positions x = y;
  set.reset_multipliers();
  for (int sweep = 0; sweep < 4000; ++sweep) set.relax(inverse_mass, dt, x);
  Forces before = Forces::Zero(3, y.cols()), after = before;
  set.add_forces(y, before);
  set.add_forces(x, after);
  return (mass / (dt * dt) * (x - y) - after).norm() / before.norm();
}

TYPED_TEST(AnElementSet, RelaxConvergesToImplicitEuler) {
  // XPBD leaves out how directions turn while it iterates; displacements grow as h², so the error
  // must fall with h² once they are small against a spring (none at all where constraints are linear).
  const Positions y = this->crumpled();
  const double coarse = missing_to_implicit_euler(*this->set_, y, 2e-4);
  const double fine = missing_to_implicit_euler(*this->set_, y, 1e-4);
  EXPECT_LE(coarse, 0.01);
  EXPECT_LE(fine, coarse / 3.0 + 1e-9);
}

TYPED_TEST(AnElementSet, RelaxKeepsMomentumAndFixedParticles) {
  const Positions y = this->crumpled();
  const int n = static_cast<int>(y.cols());
  Eigen::VectorXd inverse_mass(n);
  for (int i = 0; i < n; ++i) inverse_mass[i] = this->random_(1.0, 2000.0);
  Positions x = y;
  this->set_->reset_multipliers();
  this->set_->relax(inverse_mass, 2e-3, x);
  const Eigen::VectorXd mass = inverse_mass.cwiseInverse();
  EXPECT_LE(((x - y) * mass).norm(), 1e-14 * mass.sum());
  inverse_mass[3] = 0.0;
  Positions pinned = y;
  this->set_->reset_multipliers();
  this->set_->relax(inverse_mass, 2e-3, pinned);
  EXPECT_EQ(pinned.col(3), y.col(3));
}

TYPED_TEST(AnElementSet, AddsToForcesThatAreThere) {
  const Positions x = this->crumpled();
  Forces f = Forces::Constant(3, x.cols(), 5.0);
  this->set_->add_forces(x, f);
  EXPECT_LE((f.array() - 5.0 - this->forces(x).array()).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace pliant
