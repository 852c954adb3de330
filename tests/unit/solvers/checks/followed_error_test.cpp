// What becomes of displacements that steps missed: motions, equilibria, and what contact and
// friction leave of both.
#include "pliant/solvers/checks/followed_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/solvers/checks/step_error.h"
#include "pliant/solvers/linear/matrix_rows.h"
#include "support/solvers/system_model.h"

namespace pliant::followed_error_test {
namespace {

constexpr double kMass = 2.0, kStiffness = 500.0, kDt = 1e-3, kFriction = 0.5;
const Eigen::Vector3d kForce(0.3, 0.0, -0.7);

/// Two particles on a spring along x, the first pinned or not, on which steps miss a force.
class FollowedErrorOf {
 public:
  explicit FollowedErrorOf(bool pinned) : model_(line(), kMass) {
    model_.add("spring", {{0, 1, 1.0, kStiffness}});
    Particles& p = model_.particles();
    if (pinned) p.fix(0);
    inertia_ = p.mass / (kDt * kDt);
    force_.setZero(3, 2);
    for (int i = 0; i < 2; ++i) {
      if (!p.is_fixed(i)) force_.col(i) = kForce;
    }
  }

  /// Both slide along x over a floor, held against it by springs of that stiffness [N/m].
  void slide(double stiffness) {
    for (int i = 0; i < 2; ++i) {
      PointConstraint& point = constraints_.append();
      point.normal = Eigen::Vector3d::UnitZ();
      point.friction = kFriction;
      constraints_.add(i, 1.0);
    }
    rows_.clear(constraints_);
    for (int i = 0; i < 2; ++i) {
      rows_.append(i, Eigen::Vector3d::UnitZ(), 1.0 / stiffness, 0.0);
      // Friction acts along -x: across it is the normal times that.
      rows_.append(i, -Eigen::Vector3d::UnitY(), 1.0, 0.0);
    }
  }

  bool follow(double steps, double missing, bool are_doubled = false) {
    const double solved = are_doubled ? 0.5 * steps : steps;
    const auto& system = static_cast<const ProjectiveSystem&>(model_.system());
    hessian_.assemble(system, system.particles.x, inertia_ / (solved * solved),
                      Definiteness::kProjected);
    const Eigen::VectorXd mobility = system.particles.inverse_mass;
    hessian_.rows().clear();
    append_springs(rows_, mobility, hessian_.rows());
    hessian_.use_rows();
    const FollowedError::Missed missed = {force_,   inertia_, constraints_, rows_,
                                          mobility, kDt,      are_doubled};
    return error_.follow(hessian_, missed, steps, missing, 1e-12);
  }

  FollowedError error_;

 private:
  static Positions line() {
    Positions x = Positions::Zero(3, 2);
    x(0, 1) = 1.0;
    return x;
  }
  SystemModel model_;
  Eigen::VectorXd inertia_;
  Forces force_;
  HessianSolver hessian_;
  PointConstraints constraints_;
  PointConstraintRows rows_;
};

// Implicit Euler under a constant force: n (n + 1) / 2 times what a step misses; what came about
// before fades with a time constant of a second.
TEST(FollowedError, IsThatOfAConstantForceOnAFreeBody) {
  FollowedErrorOf body(false);
  constexpr int kSteps = 10;
  for (int k = 0; k < kSteps; ++k) ASSERT_TRUE(body.follow(1.0, 1.0));
  const Eigen::Vector3d one = kDt * kDt / kMass * kForce;
  const Eigen::Vector3d exact = 0.5 * kSteps * (kSteps + 1) * one;
  const double fades = kSteps * kDt / FollowedError::kHorizon;
  for (int i = 0; i < 2; ++i) {
    EXPECT_LE((body.error_.off().col(i) - exact).norm(), fades * exact.norm());
    EXPECT_LE((body.error_.gained().col(i) - kSteps * one).norm(), fades * kSteps * one.norm());
  }
}

// One long step is as good as many short ones, to first order.
TEST(FollowedError, TakesManyStepsAtOnce) {
  FollowedErrorOf short_steps(false), long_steps(false);
  for (int k = 0; k < 64; ++k) ASSERT_TRUE(short_steps.follow(1.0, 1.0));
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(long_steps.follow(8.0, 8.0));
  const double a = short_steps.error_.off()(0, 1), b = long_steps.error_.off()(0, 1);
  EXPECT_NEAR(b / a, (8.0 * 9.0 * 64.0) / (64.0 * 65.0), 0.01);
}

// Steps of the midpoint rule are exact for a constant force: each of them is two of half its
// length.
TEST(FollowedError, OfDoubledStepsIsThatOfTheMidpointRule) {
  FollowedErrorOf body(false);
  constexpr int kSteps = 10;
  for (int k = 0; k < kSteps; ++k) ASSERT_TRUE(body.follow(2.0, 2.0, true));
  const double time = 2.0 * kSteps * kDt;
  const Eigen::Vector3d speed = time / kMass * kForce, exact = 0.5 * time * speed;
  const double fades = time / FollowedError::kHorizon;
  EXPECT_LE((body.error_.off().col(1) - exact).norm(), fades * exact.norm());
  EXPECT_LE((body.error_.gained().col(1) - kDt * speed).norm(), fades * kDt * speed.norm());
}

// The rule damps no swing: what is off goes from 0 to twice what the spring is longer at rest, and
// back, but for what fades in half a second, 0.6. In the 25 steps of this time implicit Euler
// leaves (1 + w² T²)^(-25/2) = 0.3 of a swing.
TEST(FollowedError, OfDoubledStepsSwingsOn) {
  double largest[2] = {};
  for (const bool are_doubled : {false, true}) {
    FollowedErrorOf body(true);
    for (int k = 0; k < 400; ++k) {
      ASSERT_TRUE(body.follow(20.0, 20.0, are_doubled));
      // What came about earlier fades, too.
      if (k * 20.0 * kDt < 0.5 || k * 20.0 * kDt > 1.0) continue;
      largest[are_doubled] = std::max(largest[are_doubled], body.error_.off()(0, 1));
    }
  }
  const double at_rest = kForce[0] / kStiffness;
  EXPECT_LE(largest[0], (1.0 + 0.3 * 0.6 + 0.02) * at_rest);
  EXPECT_GE(largest[1], 1.3 * at_rest);
}

// A step that missed something among steps that did not.
TEST(FollowedError, MissesOnceWhatOneStepMissed) {
  FollowedErrorOf body(false);
  ASSERT_TRUE(body.follow(8.0, 1.0));
  EXPECT_NEAR(body.error_.gained()(0, 0), kDt * kDt / kMass * kForce[0], 1e-12);
}

// Along the spring it comes to rest where that takes the force up, f/k.
TEST(FollowedError, IsAWrongEquilibriumWhereElementsHold) {
  FollowedErrorOf body(true);
  for (int k = 0; k < 200; ++k) ASSERT_TRUE(body.follow(64.0, 64.0));
  const double fades = 64.0 * kDt / FollowedError::kHorizon;
  EXPECT_NEAR(body.error_.off()(0, 1), kForce[0] / kStiffness, fades * kForce[0] / kStiffness);
  EXPECT_EQ(body.error_.off().col(0), Eigen::Vector3d::Zero());
}

// A force that presses more makes more friction where a body slides.
TEST(FollowedError, RubsMoreWherePointsPressMore) {
  FollowedErrorOf body(false);
  body.slide(1e9);
  ASSERT_TRUE(body.follow(1.0, 1.0));
  const double along = kForce[0] + kFriction * kForce[2];
  const Positions& off = body.error_.off();
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(off(0, i), kDt * kDt / kMass * along, 1e-3 * kDt * kDt / kMass);
    EXPECT_LE(std::abs(off(2, i)), 1e-3 * kDt * kDt);
  }
}

// What holds a point takes its error back without throwing it.
TEST(FollowedError, SettlesWhereAPointIsHeld) {
  FollowedErrorOf body(false);
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(body.follow(1.0, 1.0));
  const double before = std::abs(body.error_.off()(2, 0));
  body.slide(1e9);
  ASSERT_TRUE(body.follow(1.0, 0.0));
  EXPECT_LE(std::abs(body.error_.gained()(2, 0)), 0.03 * before);
  for (int k = 0; k < 500; ++k) ASSERT_TRUE(body.follow(1.0, 0.0));
  EXPECT_LE(std::abs(body.error_.off()(2, 0)), 1e-3 * before);
}

TEST(FollowedError, GoesOnFromSavedNumbers) {
  FollowedErrorOf body(true);
  ASSERT_TRUE(body.follow(1.0, 1.0));
  StateArchive numbers;
  body.error_.save(numbers);
  const Positions off = body.error_.off(), gained = body.error_.gained();
  FollowedError other;
  other.load(numbers);
  EXPECT_EQ(other.off(), off);
  EXPECT_EQ(other.gained(), gained);
  // None, and those of one that saved less.
  numbers.clear();
  other.load(numbers);
  EXPECT_EQ(other.off().cols(), 0);
}

// Two free particles that a step left where they were, though a force moved them: twice that over
// how far they came, which counts no less than a hundredth of the body's size.
TEST(StepErrorEstimate, IsAShareOfTheDisplacementFromTheStart) {
  Positions x = Positions::Zero(3, 2);
  x(0, 1) = 1.0;
  SystemModel model(x, kMass);
  model.add("spring", {{0, 1, 1.0, kStiffness}});
  auto& system = static_cast<ProjectiveSystem&>(model.system());
  Particles& p = system.particles;
  p.x_start = x;
  p.v_start.setZero(3, 2);
  const double dt = 0.01, force = 1.0, missed = dt * dt * force / kMass;
  system.external_forces = Forces::Zero(3, 2);
  system.external_forces.row(1).setConstant(force);
  const double least = 1e-2 * 0.5;  // both are half a metre from their centre
  for (const double displacement : {0.2, 0.1, 0.02, 0.002, 0.0}) {
    Positions first = x;
    first.row(1).array() -= displacement;
    system.first_positions = &first;
    StepErrorEstimate estimate;
    estimate.prepare(system);
    ASSERT_TRUE(estimate.suits());
    estimate.begin();
    const double expected = 2.0 * missed / std::max(displacement + missed, least);
    EXPECT_NEAR(estimate.estimate(system, dt, {}), expected, 5e-3 * expected) << displacement;
  }
}

}  // namespace
}  // namespace pliant::followed_error_test
