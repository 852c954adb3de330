// Newton's second law in what steps report: kept to round-off, and its violation told by its size.
#include "pliant/solvers/checks/impulse_imbalance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/solvers/system_model.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::impulse_imbalance_test {
namespace {

constexpr double kDt = 0.01;

/// Two particles of 2 kg on a spring, on which gravity has acted for a step.
struct Pair {
  Pair() : model(two_meters_apart(), 2.0) {
    model.add("spring", {{0, 1, 2.0, 100.0}});
    ProjectiveSystem& s = system();
    s.particles.v_start.setZero(3, 2);
    s.external_forces = Eigen::Vector3d(0, 0, -20.0).replicate(1, 2);
    s.particles.v = Eigen::Vector3d(0, 0, -0.1).replicate(1, 2);
    imbalance.prepare(s);
  }
  ProjectiveSystem& system() { return static_cast<ProjectiveSystem&>(model.system()); }
  static Positions two_meters_apart() {
    Positions x = Positions::Zero(3, 2);
    x(0, 1) = 2.0;
    return x;
  }
  double find() { return imbalance.find(system(), kDt); }

  SystemModel model;
  ImpulseImbalance imbalance;
};

TEST(ImpulseImbalance, IsNothingWhereForcesGiveTheMomentum) {
  Pair pair;
  ASSERT_TRUE(pair.imbalance.is_known());
  EXPECT_LE(pair.find(), 1e-15);
  // Forces between them change nothing of it.
  pair.system().particles.v.col(0) += Eigen::Vector3d(0.3, 0, 0);
  pair.system().particles.v.col(1) -= Eigen::Vector3d(0.3, 0, 0);
  EXPECT_LE(pair.find(), 1e-15);
}

// Missed: 3/4 of 0.4 N s; the sizes: that, and the quarter that was gained.
TEST(ImpulseImbalance, IsTheShareOfTheMomentumThatIsMissed) {
  Pair pair;
  pair.system().particles.v *= 0.25;
  EXPECT_NEAR(pair.find(), 0.3 / (0.4 + 0.1), 1e-14);
}

// Both turn about the middle: no momentum, but angular momentum that no force gave.
TEST(ImpulseImbalance, TellsOfTorquesToo) {
  Pair pair;
  pair.system().external_forces.setZero();
  pair.system().particles.v << 0, 0, 0, 0, 0.5, -0.5;
  EXPECT_NEAR(pair.find(), 1.0, 1e-14);
}

TEST(ImpulseImbalance, WhatIsHeldAndSingleVerticesHaveNone) {
  Pair pair;
  pair.model.particles().fix(0);
  pair.imbalance.prepare(pair.system());
  EXPECT_FALSE(pair.imbalance.is_known());
  SystemModel loose(Pair::two_meters_apart());
  pair.imbalance.prepare(static_cast<ProjectiveSystem&>(loose.system()));
  EXPECT_FALSE(pair.imbalance.is_known());
}

// In contact and with friction, with the iterations that solvers have by themselves: what contact's
// final projection moves is no force that is told. An energy that was gained is told where it is
// known.
class ImpulseImbalanceOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, ImpulseImbalanceOf,
                         testing::Values("chebyshev", "direct", "gauss_seidel", "hybrid", "jacobi",
                                         "lbfgs", "newton", "line_search_jacobi", "xpbd"),
                         [](const auto& info) { return info.param; });

TEST_P(ImpulseImbalanceOf, ABallThatLandsIsBelowAThousandth) {
  const auto world = make_world(falling_ball(GetParam(), {}));
  bool was_found = false;
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(world->step()) << world->failure();
    const StepReport& report = body_of(*world).report;
    ASSERT_TRUE(report.impulse_imbalance.has_value());
    EXPECT_LE(*report.impulse_imbalance, 1e-3) << k;
    if (!report.energy_gained) continue;
    was_found = true;
    EXPECT_TRUE(std::isfinite(*report.energy_gained));
  }
  EXPECT_TRUE(was_found);
}

}  // namespace
}  // namespace pliant::impulse_imbalance_test
