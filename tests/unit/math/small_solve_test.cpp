#include "pliant/math/small_solve.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

template <int N, int M>
void solves(const Eigen::Matrix<double, N, N>& a, double tolerance) {
  Eigen::Matrix<double, N, M> x;
  for (int i = 0; i < x.size(); ++i) x.data()[i] = 1.0 + i;
  const Eigen::Matrix<double, N, M> b = a * x;
  const Eigen::Matrix<double, N, M> solution = solve_pivoted<N, M>(a, b);
  EXPECT_LE((solution - x).cwiseAbs().maxCoeff(), tolerance);
}

TEST(SmallSolve, SolvesWhatNeedsNoPivot) {
  solves<3, 3>(Eigen::Vector3d(1e-8, 3.0, 1e8).asDiagonal().toDenseMatrix(), 1e-14);
  Eigen::Matrix2d a;
  a << 4.0, 1.0, -2.0, 3.0;
  solves<2, 3>(a, 1e-14);
}

TEST(SmallSolve, SolvesWhatNeedsOne) {
  Eigen::Matrix3d a;
  a << 0.0, 2.0, 1.0, 1e-20, 0.0, 3.0, 5.0, 1.0, 0.0;
  solves<3, 3>(a, 1e-14);
  solves<3, 1>(a, 1e-14);
  Eigen::Matrix<double, 6, 6> permuted = Eigen::Matrix<double, 6, 6>::Zero();
  const int order[] = {3, 5, 0, 1, 4, 2};
  for (int i = 0; i < 6; ++i) permuted(i, order[i]) = 1.0 + i;
  solves<6, 1>(permuted, 1e-14);
}

TEST(SmallSolve, SingularMatricesGiveNothingFinite) {
  const Eigen::Vector2d x = solve_pivoted<2, 1>(Eigen::Matrix2d::Ones(), Eigen::Vector2d(1.0, 2.0));
  EXPECT_FALSE(x.allFinite());
}

}  // namespace
}  // namespace pliant
