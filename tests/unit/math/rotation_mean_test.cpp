#include "pliant/math/rotation_mean.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

Eigen::Quaterniond turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

TEST(RotationMean, OfTwoIsHalfWayWhateverTheSigns) {
  const Eigen::Vector3d axis(1.0, 2.0, -1.0);
  Eigen::Matrix4Xd both(4, 2);
  both.col(0) = turn(0.2, axis).coeffs();
  both.col(1) = -turn(1.0, axis).coeffs();
  const Eigen::VectorXd weights = Eigen::VectorXd::Ones(2);
  EXPECT_NEAR(linear_rotation_mean(both, weights).angularDistance(turn(0.6, axis)), 0.0, 1e-12);
  EXPECT_NEAR(exponential_rotation_mean(both, weights).angularDistance(turn(0.6, axis)), 0.0,
              1e-12);
}

TEST(RotationMean, WeightsOfTheExponentialMeanAreThoseOfAngles) {
  const Eigen::Vector3d axis(0.0, 1.0, 0.0);
  Eigen::Matrix4Xd both(4, 2);
  both.col(0) = turn(0.0, axis).coeffs();
  both.col(1) = turn(2.0, axis).coeffs();
  const Eigen::Vector2d weights(3.0, 1.0);
  EXPECT_NEAR(exponential_rotation_mean(both, weights, 20).angularDistance(turn(0.5, axis)), 0.0,
              1e-9);
  // The linear one is near it for turns that are near each other only: tan(θ/2) = sin 1/(3 + cos 1)
  // for half angles.
  const double linear = 2.0 * std::atan2(std::sin(1.0), 3.0 + std::cos(1.0));
  EXPECT_NEAR(linear_rotation_mean(both, weights).angularDistance(turn(linear, axis)), 0.0, 1e-12);
}

TEST(RotationMean, OppositeTurnsLeaveARotation) {
  Eigen::Matrix4Xd both(4, 2);
  both << 0, 1, 0, 0, 0, 0, 1, 0;
  const Eigen::Quaterniond mean = linear_rotation_mean(both, Eigen::Vector2d(1.0, 1.0));
  EXPECT_NEAR(mean.norm(), 1.0, 1e-12);
  both.col(1) = -both.col(0);
  EXPECT_NEAR(exponential_rotation_mean(both, Eigen::Vector2d(1.0, 1.0)).norm(), 1.0, 1e-12);
}

}  // namespace
}  // namespace pliant
