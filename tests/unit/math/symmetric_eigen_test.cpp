#include "pliant/math/symmetric_eigen.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/math/pi.h"
#include "support/epsilon.h"

namespace pliant::symmetric_eigen_test {
namespace {

constexpr int kSize = 12;
// |error| <= a few n ε |A|, |A| < 4.
constexpr double kRoundOff = 4.0 * 4.0 * kSize * kEpsilon;

/// The second difference's: 2 - 2 cos(k π / (n + 1)), k = 1 to n.
Eigen::VectorXd exact_values() {
  Eigen::VectorXd values(kSize);
  for (int k = 0; k < kSize; ++k) values[k] = 2.0 - 2.0 * std::cos((k + 1) * kPi / (kSize + 1));
  return values;
}

Eigen::MatrixXd second_difference() {
  Eigen::MatrixXd a = 2.0 * Eigen::MatrixXd::Identity(kSize, kSize);
  a.diagonal(1).setConstant(-1.0);
  a.diagonal(-1).setConstant(-1.0);
  return a;
}

TEST(SymmetricEigen, ValuesOfTheSecondDifferenceRise) {
  const Eigen::VectorXd exact = exact_values();
  EXPECT_LE((symmetric_eigenvalues(second_difference()) - exact).norm(), kRoundOff);
  const Eigen::VectorXd beside = Eigen::VectorXd::Constant(kSize - 1, -1.0);
  const Eigen::VectorXd values =
      tridiagonal_eigenvalues(Eigen::VectorXd::Constant(kSize, 2.0), beside);
  EXPECT_LE((values - exact).norm(), kRoundOff);
}

TEST(SymmetricEigen, VectorsAreOrthonormalAndMakeTheMatrix) {
  const Eigen::MatrixXd a = second_difference();
  const SymmetricEigen eigen = symmetric_eigen(a);
  const Eigen::MatrixXd& v = eigen.vectors;
  EXPECT_LE((v.transpose() * v - Eigen::MatrixXd::Identity(kSize, kSize)).norm(), kRoundOff);
  EXPECT_LE((v * eigen.values.asDiagonal() * v.transpose() - a).norm(), kRoundOff);
}

TEST(SymmetricEigen, ReadsTheLowerHalf) {
  Eigen::MatrixXd a = second_difference();
  a.triangularView<Eigen::StrictlyUpper>().setZero();
  EXPECT_LE((symmetric_eigenvalues(a) - exact_values()).norm(), kRoundOff);
}

}  // namespace
}  // namespace pliant::symmetric_eigen_test
