#pragma once

#include <Eigen/Core>
#include <cmath>
#include <utility>

namespace pliant {

/// X of A X = B by elimination with row pivoting: `a` is N x N, `b` is N x M. A singular `a` gives
/// infinities or NaN. Eigen's partialPivLu() does the same by what is made for many equations,
/// which takes three times as long, and the compiler seconds in every file that names it.
template <int N, int M>
Eigen::Matrix<double, N, M> solve_pivoted(Eigen::Matrix<double, N, N> a,
                                          Eigen::Matrix<double, N, M> b) {
  for (int k = 0; k < N; ++k) {
    int pivot = k;
    for (int i = k + 1; i < N; ++i) {
      if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
    }
    if (pivot != k) {
      for (int j = 0; j < N; ++j) std::swap(a(k, j), a(pivot, j));
      for (int j = 0; j < M; ++j) std::swap(b(k, j), b(pivot, j));
    }
    for (int i = k + 1; i < N; ++i) {
      a(i, k) /= a(k, k);
      for (int j = k + 1; j < N; ++j) a(i, j) -= a(i, k) * a(k, j);
    }
  }
  const auto subtract_known = [&](int row, int begin, int end, int j) {
    if (begin >= end) return;
    double known = a(row, begin) * b(begin, j);
    for (int k = begin + 1; k < end; ++k) known += a(row, k) * b(k, j);
    b(row, j) -= known;
  };
  for (int j = 0; j < M; ++j) {
    for (int k = 1; k < N; ++k) subtract_known(k, 0, k, j);
    for (int k = N - 1; k >= 0; --k) {
      subtract_known(k, k + 1, N, j);
      b(k, j) *= 1.0 / a(k, k);
    }
  }
  return b;
}

}  // namespace pliant
