#pragma once

#include "pliant/math/rotation_secular.h"

/// A start near the best rotation from the matrix alone. Branch-free, as rotation_secular.h.
namespace pliant::rotation_detail {

// The largest eigenvalue λ of K(F) from above, by one Newton step on its characteristic polynomial
//
//   (λ² - N)² - 8 det F λ - 4c = 0,    N = |F|², c = |adj F|²
//
// (F. L. Markley, "Attitude determination using vector observations: a fast optimal matrix
// algorithm", J. Astronaut. Sci. 41, 1993). Since λ² = N + 2(σ₁σ₂ + σ₂σ₃ + σ₃σ₁) and c is the sum
// of these products' squares, λ² ≤ N + 2√(3c), and N + 2√c where σ₃ is negative.
template <typename T>
PLIANT_HOST_DEVICE inline T largest_eigenvalue(const Matrix3<T>& f) {
  T square[9];
  for (int k = 0; k < 9; ++k) square[k] = f.m[k] * f.m[k];
  const T n = ((square[0] + square[1]) + (square[2] + square[3])) +
              (((square[4] + square[5]) + (square[6] + square[7])) + square[8]);
  const T g00 = f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1);
  const T g01 = f(1, 2) * f(2, 0) - f(1, 0) * f(2, 2);
  const T g02 = f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0);
  const T g10 = f(2, 1) * f(0, 2) - f(2, 2) * f(0, 1);
  const T g11 = f(2, 2) * f(0, 0) - f(2, 0) * f(0, 2);
  const T g12 = f(2, 0) * f(0, 1) - f(2, 1) * f(0, 0);
  const T g20 = f(0, 1) * f(1, 2) - f(0, 2) * f(1, 1);
  const T g21 = f(0, 2) * f(1, 0) - f(0, 0) * f(1, 2);
  const T g22 = f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0);
  const T det = f(0, 0) * g00 + (f(0, 1) * g01 + f(0, 2) * g02);
  const T c = ((g00 * g00 + g01 * g01) + (g02 * g02 + g10 * g10)) +
              (((g11 * g11 + g12 * g12) + (g20 * g20 + g21 * g21)) + g22 * g22);
  const T lambda = std::sqrt(n + T(2) * std::sqrt(det > T(0) ? T(3) * c : c));
  const T u = lambda * lambda - n;
  return lambda - (u * u - (T(8) * det * lambda + T(4) * c)) / (T(4) * lambda * u - T(8) * det);
}

/// Half a turn about an axis of the frame, or none: the rotation diag(s0, s1, s2).
template <typename T>
struct HalfTurn {
  T s0, s1, s2;
};

// The one of 1, i, j, k with the largest component in the eigenvector v of λ: adj(λI - K) is
// nearly a multiple of vvᵀ, so that its largest diagonal entry says which. Then |v_i| ≥ 1/2.
template <typename T>
PLIANT_HOST_DEVICE inline HalfTurn<T> nearest_half_turn(const Matrix3<T>& f, T lambda) {
  const T b00 = lambda - (f(0, 0) + (f(1, 1) + f(2, 2)));
  const T b11 = lambda - (f(0, 0) - (f(1, 1) + f(2, 2)));
  const T b22 = lambda - (f(1, 1) - (f(0, 0) + f(2, 2)));
  const T b33 = lambda - (f(2, 2) - (f(0, 0) + f(1, 1)));
  const T b01 = f(1, 2) - f(2, 1), b02 = f(2, 0) - f(0, 2), b03 = f(0, 1) - f(1, 0);
  const T b12 = -(f(0, 1) + f(1, 0)), b13 = -(f(0, 2) + f(2, 0)), b23 = -(f(1, 2) + f(2, 1));
  // Minors of rows 0 and 1 (upper) and of rows 2 and 3 (lower), by their two columns.
  const T upper01 = b00 * b11 - b01 * b01;
  const T upper02 = b00 * b12 - b02 * b01, upper03 = b00 * b13 - b03 * b01;
  const T upper12 = b01 * b12 - b02 * b11, upper13 = b01 * b13 - b03 * b11;
  const T lower23 = b22 * b33 - b23 * b23;
  const T lower13 = b12 * b33 - b13 * b23, lower12 = b12 * b23 - b13 * b22;
  const T lower03 = b02 * b33 - b03 * b23, lower02 = b02 * b23 - b03 * b22;
  const T adj00 = b11 * lower23 + (b13 * lower12 - b12 * lower13);
  const T adj11 = b00 * lower23 + (b03 * lower02 - b02 * lower03);
  const T adj22 = b33 * upper01 + (b03 * upper13 - b13 * upper03);
  const T adj33 = b22 * upper01 + (b02 * upper12 - b12 * upper02);
  const T best = larger(larger(adj00, adj11), larger(adj22, adj33));
  const bool none = adj00 == best;
  const bool about_0 = !none & (adj11 == best);
  const bool about_1 = !none & !about_0 & (adj22 == best);
  HalfTurn<T> turn;
  turn.s0 = (none | about_0) ? T(1) : T(-1);
  turn.s1 = (none | about_1) ? T(1) : T(-1);
  turn.s2 = turn.s0 * turn.s1;
  return turn;
}

/// About a degree from the best rotation, of unit length; NaN or poor where F hardly determines a
/// rotation, which `refine` notices.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> cold_start(const Matrix3<T>& f) {
  const T lambda = largest_eigenvalue(f);
  const HalfTurn<T> turn = nearest_half_turn(f, lambda);
  Matrix3<T> m;
  for (int j = 0; j < 3; ++j) {
    m(0, j) = turn.s0 * f(0, j);
    m(1, j) = turn.s1 * f(1, j);
    m(2, j) = turn.s2 * f(2, j);
  }
  const Root<T> root = solve_secular(make_frame(m), lambda - (m(0, 0) + (m(1, 1) + m(2, 2))));
  // (1, y) from the left times 1, i, j or k
  const T y0 = root.y0, y1 = root.y1, y2 = root.y2;
  const bool p = turn.s0 > T(0), q = turn.s1 > T(0);
  return {p ? (q ? T(1) : -y0) : (q ? -y1 : -y2),  //
          p ? (q ? y0 : T(1)) : (q ? y2 : -y1),    //
          p ? (q ? y1 : -y2) : (q ? T(1) : y0),    //
          p ? (q ? y2 : y1) : (q ? -y0 : T(1))};
}

}  // namespace pliant::rotation_detail
