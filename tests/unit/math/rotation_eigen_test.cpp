#include "pliant/math/rotation_eigen.h"

#include <gtest/gtest.h>

#include "support/rotation_cases.h"

namespace pliant {
namespace {

TEST(RotationEigenTest, IsTheSameRotation) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const RotationCase c = rotation_case(random, i);
    const Quaternion<double> warm =
        nearest_rotation(plain_matrix<double>(c.f), plain_quaternion<double>(c.warm_start));
    EXPECT_EQ(nearest_rotation(c.f, c.warm_start).coeffs(), wide(warm).coeffs());
    EXPECT_EQ(nearest_rotation(c.f).coeffs(),
              wide(nearest_rotation(plain_matrix<double>(c.f))).coeffs());
    // Columns and rows are not mixed up, and expressions are taken as they are.
    EXPECT_EQ(nearest_rotation(2.0 * c.f.transpose()).coeffs(),
              wide(nearest_rotation(plain_matrix<double>(2.0 * c.f.transpose()))).coeffs());
  }
}

TEST(RotationEigenTest, TakesFloat) {
  const Eigen::Matrix3f f = Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  const Eigen::Quaternionf q = nearest_rotation(f, Eigen::Quaternionf::Identity());
  EXPECT_LT((q.toRotationMatrix() - f).norm(), 1e-6f);
}

// The plain quaternion's product and matrix mean what Eigen's do.
TEST(RotationEigenTest, PlainQuaternionsFollowEigen) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Quaterniond a(random.rotation()), b(random.rotation());
    const Quaternion<double> product = plain_quaternion<double>(a) * plain_quaternion<double>(b);
    EXPECT_LT((to_eigen(product).coeffs() - (a * b).coeffs()).norm(), 1e-15);
    const Matrix3<double> matrix = to_matrix(plain_quaternion<double>(a));
    EXPECT_LT((wide(matrix) - a.toRotationMatrix()).norm(), 1e-14);
  }
}

}  // namespace
}  // namespace pliant
