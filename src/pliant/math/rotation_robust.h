#pragma once

#include "pliant/math/rotation_secular.h"

/// The rare path of nearest_rotation (rotation.h): matrices that hardly determine a rotation.
namespace pliant::rotation_detail {

/// The symmetric matrix K(F) of rotation_secular.h, and a basis that turns into its eigenvectors.
template <typename T>
struct Eigenproblem {
  T k[4][4];
  T v[4][4];  ///< one eigenvector a column
};

template <typename T>
PLIANT_HOST_DEVICE inline Eigenproblem<T> horn_eigenproblem(const Matrix3<T>& f) {
  const T trace = f(0, 0) + f(1, 1) + f(2, 2);
  Eigenproblem<T> e{};
  e.k[0][0] = trace;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, l = (i + 2) % 3;
    e.k[0][i + 1] = e.k[i + 1][0] = f(l, j) - f(j, l);
    e.k[i + 1][j + 1] = e.k[j + 1][i + 1] = f(i, j) + f(j, i);
    e.k[i + 1][i + 1] = T(2) * f(i, i) - trace;
  }
  for (int i = 0; i < 4; ++i) e.v[i][i] = T(1);
  return e;
}

// Jacobi's rotation in the plane (p, q) that makes K_pq zero (G. H. Golub and C. F. Van Loan,
// "Matrix Computations", 8.5); false where it is zero already, as far as its square tells.
template <typename T>
PLIANT_HOST_DEVICE inline bool rotate_plane(Eigenproblem<T>& e, int p, int q, T negligible) {
  const T off = e.k[p][q];
  if (off * off <= negligible) return false;
  const T theta = (e.k[q][q] - e.k[p][p]) / (T(2) * off);
  const T size = T(1) / (std::abs(theta) + std::sqrt(theta * theta + T(1)));
  const T t = theta < T(0) ? -size : size;
  const T c = T(1) / std::sqrt(t * t + T(1)), s = t * c;
  e.k[p][p] -= t * off;
  e.k[q][q] += t * off;
  e.k[p][q] = e.k[q][p] = T(0);
  for (int i = 0; i < 4; ++i) {
    if (i != p && i != q) {
      const T kip = e.k[i][p], kiq = e.k[i][q];
      e.k[i][p] = e.k[p][i] = c * kip - s * kiq;
      e.k[i][q] = e.k[q][i] = s * kip + c * kiq;
    }
    const T vip = e.v[i][p], viq = e.v[i][q];
    e.v[i][p] = c * vip - s * viq;
    e.v[i][q] = s * vip + c * viq;
  }
  return true;
}

template <typename T>
PLIANT_HOST_DEVICE inline void diagonalise(Eigenproblem<T>& e, T squared_norm) {
  constexpr int kMaxSweeps = 12;  // five or six are usual
  const T negligible = T(0.001) * Limits<T>::kEpsilon * Limits<T>::kEpsilon * squared_norm;
  bool rotated = true;
  for (int sweep = 0; rotated && sweep < kMaxSweeps; ++sweep) {
    rotated = false;
    for (int p = 0; p < 3; ++p) {
      for (int q = p + 1; q < 4; ++q) rotated |= rotate_plane(e, p, q, negligible);
    }
  }
}

/// In the frame of the warm start, which is (1, 0, 0, 0) there: its projection onto the
/// eigenvectors whose eigenvalues round-off cannot tell from the largest. That is the best rotation
/// nearest to the warm start. Between 8 ε|F| and twice that an eigenvector's weight falls from 1 to
/// 0, so that the rotation does not jump when a matrix is about to lose or to regain one.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> project_on_best(const Eigenproblem<T>& e, T norm) {
  int best = 0;
  for (int i = 1; i < 4; ++i) best = e.k[i][i] > e.k[best][best] ? i : best;
  const T tolerance = T(8) * Limits<T>::kEpsilon * norm;
  T q[4] = {T(0), T(0), T(0), T(0)};
  for (int i = 0; i < 4; ++i) {
    T weight = T(2) - (e.k[best][best] - e.k[i][i]) / tolerance;
    weight = weight < T(0) ? T(0) : (weight > T(1) ? T(1) : weight);
    for (int j = 0; j < 4; ++j) q[j] += weight * e.v[0][i] * e.v[j][i];
  }
  const Quaternion<T> projection{q[0], q[1], q[2], q[3]};
  // Half a turn away from every best rotation: one is as near as the other.
  if (dot(projection, projection) < Limits<T>::kEpsilon * Limits<T>::kEpsilon) {
    return {e.v[0][best], e.v[1][best], e.v[2][best], e.v[3][best]};
  }
  return normalised(projection);
}

/// `f` scaled; `warm_start` of unit length, and returned as it is for zero, NaN and infinity.
template <typename T>
PLIANT_RARE_PATH PLIANT_HOST_DEVICE Quaternion<T> robust_rotation(const Matrix3<T>& f,
                                                                  const Quaternion<T>& warm_start) {
  T squared_norm = T(0);
  for (int k = 0; k < 9; ++k) squared_norm += f.m[k] * f.m[k];
  if (!(squared_norm > T(0))) return warm_start;
  Eigenproblem<T> e = horn_eigenproblem(transpose_times(to_matrix(warm_start), f));
  diagonalise(e, squared_norm);
  return normalised(warm_start * project_on_best(e, std::sqrt(squared_norm)));
}

}  // namespace pliant::rotation_detail
