#include "pliant/core/body/embedded_points.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace pliant {
namespace {

/// Two points: the middle of four particles, and one outside of them.
EmbeddedPoints two_points() {
  Eigen::Matrix4Xi particles(4, 2);
  particles << 0, 1,  //
      1, 2,           //
      2, 3,           //
      3, 4;
  Eigen::Matrix4Xd weights(4, 2);
  weights << 0.25, 1.5,  //
      0.25, -0.5,        //
      0.25, 0.25,        //
      0.25, -0.25;
  return {particles, weights};
}

TEST(EmbeddedPoints, AreWeightedMeans) {
  const Positions x = Positions::Random(3, 5);
  const EmbeddedPoints points = two_points();
  ASSERT_EQ(points.size(), 2);
  const Eigen::Vector3d middle = x.leftCols<4>().rowwise().mean();
  EXPECT_LE((points.position(x, 0) - middle).norm(), 1e-15);
  Eigen::Matrix3Xd all(3, 2);
  points.positions(x, all);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(all.col(k), points.position(x, k));
}

TEST(EmbeddedPoints, MoveRigidlyWithTheirParticles) {
  const Positions x = Positions::Random(3, 5);
  const EmbeddedPoints points = two_points();
  const Eigen::Isometry3d pose =
      Eigen::Translation3d(1.0, -2.0, 0.5) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 2) / 3.0);
  const Positions moved = (pose.linear() * x).colwise() + pose.translation();
  for (int k = 0; k < 2; ++k) {
    EXPECT_LE((points.position(moved, k) - pose * points.position(x, k)).norm(), 1e-14);
  }
}

TEST(EmbeddedPoints, InterpolateLinearFieldsExactly) {
  const Positions x = Positions::Random(3, 5);
  const EmbeddedPoints points = two_points();
  const Eigen::Vector3d slope(0.3, -1.0, 2.0);
  const Eigen::VectorXd field = (slope.transpose() * x).transpose().array() + 4.0;
  const Eigen::VectorXd at_points = points.interpolate(field);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(at_points[k], slope.dot(points.position(x, k)) + 4.0, 1e-14);
  }
}

}  // namespace
}  // namespace pliant
