#include "pliant/solvers/rigid_mode.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace pliant::rigid_mode_test {
namespace {

TEST(RigidMode, SolvesWherePivotsAreZero) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    rigid::Matrix6 a;
    rigid::Vector6 exact;
    for (int i = 0; i < 6; ++i) {
      exact[i] = random(-1.0, 1.0);
      for (int j = 0; j < 6; ++j) a(i, j) = i + j < 5 ? 0.0 : random(0.5, 1.0);
    }
    rigid::Vector6 b = a * exact;
    EXPECT_LT((rigid::solve(a, b) - exact).norm(), 1e-12);
  }
}

/// Of points of any masses, about the origin; nothing acts.
rigid::Sums sums_of(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& masses) {
  rigid::Sums sums;
  for (int i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d q = points.col(i);
    sums.mass += masses[i];
    sums.first += masses[i] * q;
    sums.second += masses[i] * q * q.transpose();
  }
  return sums;
}

TEST(RigidMode, HoldsTheMomentumOfItsMotion) {
  constexpr int kCount = 12;
  constexpr double kRate = 400.0;
  Random random(7);
  const Eigen::Matrix3Xd points = random.positions(kCount, 1.0);
  const Eigen::VectorXd masses = Eigen::VectorXd::LinSpaced(kCount, 0.1, 1.0);
  const Eigen::Vector3d origin(5.0, -3.0, 2.0);
  const rigid::Mode mode = rigid::mode_of(sums_of(points, masses), origin, kRate);
  rigid::Vector6 motion;
  for (int k = 0; k < 6; ++k) motion[k] = random(-1.0, 1.0);
  const Eigen::Vector3d shift = motion.head<3>(), turn = motion.tail<3>() / mode.radius;
  rigid::Vector6 momentum = rigid::Vector6::Zero();
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d arm = origin + points.col(i) - mode.center;
    const Eigen::Vector3d held = kRate * masses[i] * (shift + turn.cross(arm));
    momentum.head<3>() += held;
    momentum.tail<3>() += arm.cross(held) / mode.radius;
  }
  EXPECT_LT((mode.inertia * motion - momentum).norm(), 1e-10 * momentum.norm());
  EXPECT_LT((mode.holding(momentum) - motion).norm(), 1e-10 * motion.norm());
}

TEST(RigidMode, ATurnThatIsPredictedOnStraightLinesKeepsDistances) {
  constexpr int kCount = 9;
  Random random(9);
  const Eigen::Matrix3Xd start = random.positions(kCount, 1.0);
  const Eigen::Vector3d turn(0.1, -0.3, 0.2), shift(1.0, 2.0, 3.0);
  rigid::Moments sums;
  Eigen::Matrix3Xd predicted(3, kCount);
  for (int i = 0; i < kCount; ++i) {
    const Eigen::Vector3d q = start.col(i);
    predicted.col(i) = q + turn.cross(q) + shift;
    sums.mass += 1.0;
    sums.start += q;
    sums.predicted += predicted.col(i);
    sums.second += q * q.transpose();
    sums.mixed += predicted.col(i) * q.transpose();
  }
  const rigid::Turn found = rigid::turn_of(sums);
  ASSERT_TRUE(found.any);
  for (int i = 0; i < kCount; ++i) {
    predicted.col(i) += found.way(start.col(i), predicted.col(i));
  }
  for (int i = 0; i < kCount; ++i) {
    const double before = (start.col(i) - start.col(0)).norm();
    EXPECT_NEAR((predicted.col(i) - predicted.col(0)).norm(), before, 1e-9);
  }
}

}  // namespace
}  // namespace pliant::rigid_mode_test
