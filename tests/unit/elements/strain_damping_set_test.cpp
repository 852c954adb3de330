#include "pliant/elements/solids/strain_damping_set.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "support/solvers/matrices.h"

namespace pliant {
namespace {

constexpr double kSpring = 50.0, kDampingTime = 0.02, kDampedStep = 0.01;

/// The distance of two particles, which was 1 m when the step began.
struct Pair {
  Pair() {
    StrainMeasure m;
    m.particles = {0, 1, 0, 0};
    m.first = {-1.0, 1.0, 0.0, 0.0};
    m.stiffness = kSpring;
    set = std::make_unique<StrainDampingSet>(std::vector<StrainMeasure>{m}, kDampingTime);
    Positions start(3, 2);
    start << 0, 1, 0, 0, 0, 0;
    set->prepare(kDampedStep);
    set->begin_step(Particles(start, Eigen::VectorXd::Ones(2)));
    set->reset_multipliers();
    x = start;
    x(0, 1) = 1.2;
  }
  double change() const { return (x.col(1) - x.col(0)).norm() - 1.0; }

  std::unique_ptr<StrainDampingSet> set;
  Positions x;
};

TEST(StrainDampingSet, PullsAgainstTheChangeOfItsStrain) {
  const Pair pair;
  // beta/h k = 100 N/m.
  EXPECT_NEAR(pair.set->energy(pair.x), 0.5 * 100.0 * 0.2 * 0.2, 1e-12);
  const Forces f = forces_of(*pair.set, pair.x);
  EXPECT_NEAR(f(0, 0), 100.0 * 0.2, 1e-12);
  EXPECT_NEAR(f(0, 1), -100.0 * 0.2, 1e-12);
}

TEST(StrainDampingSet, OneSweepIsImplicitEuler) {
  Pair pair;
  const Eigen::Vector2d inverse_mass(3.0, 5.0);
  // What is left of a change is 1/(1 + h² k (w0 + w1)) of it; more sweeps change nothing.
  const double left = 0.2 / (1.0 + kDampedStep * kDampedStep * 100.0 * 8.0);
  for (int sweep = 0; sweep < 3; ++sweep) {
    pair.set->relax(inverse_mass, kDampedStep, pair.x);
    EXPECT_NEAR(pair.change(), left, 1e-12) << sweep;
  }
  EXPECT_NEAR(pair.x(0, 0) / 3.0, (1.2 - pair.x(0, 1)) / 5.0, 1e-12);  // momentum
}

}  // namespace
}  // namespace pliant
