#include "pliant/math/dense_factors.h"

#include <gtest/gtest.h>

#include "support/epsilon.h"

namespace pliant {
namespace {

constexpr int kSize = 20;

/// 1 / (i + j + 1) with ones added to the diagonal: symmetric, with eigenvalues from 1 to 3.
Eigen::MatrixXd positive_definite() {
  Eigen::MatrixXd a = Eigen::MatrixXd::Identity(kSize, kSize);
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) a(i, j) += 1.0 / (i + j + 1);
  }
  return a;
}

Eigen::MatrixXd solutions() {
  Eigen::MatrixXd x(kSize, 3);
  for (int i = 0; i < kSize; ++i) x.row(i) << 1.0, i - 7.0, 0.1 * i * i;
  return x;
}

// |error| <= a few n ε |A| |A⁻¹| |x|, |x| < 40.
constexpr double kRoundOff = 4.0 * kSize * 3.0 * 40.0 * kEpsilon;

template <class Factor>
void expect_solutions(const Factor& factor, const Eigen::MatrixXd& a) {
  const Eigen::MatrixXd x = solutions();
  const Eigen::MatrixXd b = a * x;
  EXPECT_LE((factor.solve(b) - x).cwiseAbs().maxCoeff(), kRoundOff);
  for (int k = 0; k < x.cols(); ++k) {
    Eigen::VectorXd column = b.col(k);
    EXPECT_LE((factor.solve(column) - x.col(k)).cwiseAbs().maxCoeff(), kRoundOff);
    factor.solve_in_place(column);
    EXPECT_LE((column - x.col(k)).cwiseAbs().maxCoeff(), kRoundOff);
  }
}

TEST(DenseFactors, SolveColumnsOneByOneAndTogether) {
  const Eigen::MatrixXd a = positive_definite();
  expect_solutions(DenseCholesky(a), a);
  expect_solutions(DenseLdlt(a), a);
}

TEST(DenseFactors, CholeskyDividesByItsUpperFactor) {
  const Eigen::MatrixXd a = positive_definite();
  // (Lᵀ)⁻¹ of both sides makes A the identity.
  const Eigen::MatrixXd right = DenseCholesky(a).divided_by_upper(a).transpose();
  const Eigen::MatrixXd both = DenseCholesky(a).divided_by_upper(right);
  EXPECT_LE((both - Eigen::MatrixXd::Identity(kSize, kSize)).cwiseAbs().maxCoeff(), kRoundOff);
}

TEST(DenseFactors, CholeskySaysWhatIsNotPositiveDefinite) {
  DenseCholesky factor;
  Eigen::MatrixXd a = positive_definite();
  EXPECT_TRUE(factor.compute(a));
  a(3, 3) = -1.0;
  EXPECT_FALSE(factor.compute(a));
  EXPECT_TRUE(factor.compute(positive_definite()));
}

TEST(DenseFactors, LdltSolvesWhatASingularMatrixCanReach) {
  Eigen::MatrixXd a = positive_definite();
  a.row(4).setZero();
  a.col(4).setZero();
  const Eigen::VectorXd b = a * solutions().col(1);
  EXPECT_LE((a * DenseLdlt(a).solve(b) - b).cwiseAbs().maxCoeff(), 3.0 * kRoundOff);
}

TEST(DenseFactors, AnyRegularMatrixIsSolvedWithPivoting) {
  Eigen::MatrixXd a = positive_definite();
  a.row(0).swap(a.row(5));
  a(0, 0) = 0.0;
  const Eigen::VectorXd x = solutions().col(1);
  EXPECT_LE((solve_dense(a, a * x) - x).cwiseAbs().maxCoeff(), 10.0 * kRoundOff);
}

}  // namespace
}  // namespace pliant
