// The compliant sweep of every kind of element set, and that threads change no bit.
#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "unit/elements/element_fixture.h"

namespace pliant {
namespace {

template <class Set>
class ARelaxedElementSet : public AnElementSet<Set> {};
TYPED_TEST_SUITE(ARelaxedElementSet, AllSets, NameOfSet);

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

TYPED_TEST(ARelaxedElementSet, RelaxConvergesToImplicitEuler) {
  // XPBD leaves out how the directions of springs and diagonals turn while it iterates;
  // displacements grow as h², so the error must fall with h² once they are small against a spring
  // (none at all where constraints are linear).
  const Positions y = this->crumpled();
  const double coarse = missing_to_implicit_euler(*this->set_, y, 2e-4);
  const double fine = missing_to_implicit_euler(*this->set_, y, 1e-4);
  const auto name = this->set_->name();
  EXPECT_LE(coarse, name == "stretch" || name == "shear" ? 0.01 : 1e-9);
  EXPECT_LE(fine, coarse / 3.0 + 1e-9);
}

TYPED_TEST(ARelaxedElementSet, RelaxLowersTheEnergy) {
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

TYPED_TEST(ARelaxedElementSet, RelaxLeavesFixedParticles) {
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

TYPED_TEST(ARelaxedElementSet, ThreadsDoNotChangeABit) {
  const Positions one = all_results<TypeParam>(1);
  EXPECT_TRUE(one == all_results<TypeParam>(2));
  EXPECT_TRUE(one == all_results<TypeParam>(4));
}

}  // namespace
}  // namespace pliant
