#pragma once

#include <cmath>

#include "pliant/math/matrix3.h"

/// The heart of nearest_rotation (rotation.h): from a start near enough to the maximiser of
/// tr(RᵀF), the maximiser itself, with a proof. No branches but those of `refine`, and only +, -,
/// *, / and square roots: loops over the rest vectorise, and give each matrix the same bits as one
/// call.
namespace pliant::rotation_detail {

template <typename T>
struct Limits;

/// Between kSmall and kLarge no product of six entries overflows, nor underflows where it counts.
/// kTiny and kHuge have normal reciprocals; entries beyond are first multiplied by the other one.
template <>
struct Limits<float> {
  static constexpr float kEpsilon = 0x1p-23f, kRootEpsilon = 0x1p-12f;
  static constexpr float kSmall = 0x1p-20f, kLarge = 0x1p20f, kTiny = 0x1p-100f, kHuge = 0x1p100f;
};
template <>
struct Limits<double> {
  static constexpr double kEpsilon = 0x1p-52, kRootEpsilon = 0x1p-26;
  static constexpr double kSmall = 0x1p-150, kLarge = 0x1p150, kTiny = 0x1p-900, kHuge = 0x1p900;
};

/// Solves of the secular equation in one frame before `refine` gives up; one or two are usual.
constexpr int kMaxSolves = 5;
/// One is usual; a second where F is nearly singular and the start far away.
constexpr int kMaxFrames = 3;

template <typename T>
PLIANT_HOST_DEVICE inline T larger(T a, T b) {
  return a < b ? b : a;
}

/// Ignores NaN.
template <typename T>
PLIANT_HOST_DEVICE inline T largest_entry(const Matrix3<T>& f) {
  T size[9];
  for (int k = 0; k < 9; ++k) size[k] = std::abs(f.m[k]);
  const T first = larger(larger(size[0], size[1]), larger(size[2], size[3]));
  const T last = larger(larger(size[4], size[5]), larger(size[6], size[7]));
  return larger(larger(first, last), larger(size[8], T(0)));
}

/// No product of six entries overflows or underflows.
template <typename T>
PLIANT_HOST_DEVICE inline bool is_ordinary(const Matrix3<T>& f) {
  const T size = largest_entry(f);
  return (size > Limits<T>::kSmall) & (size < Limits<T>::kLarge);
}

/// F with a largest entry of 1; itself where it is ordinary. Zero and infinity become NaN.
template <typename T>
PLIANT_HOST_DEVICE inline Matrix3<T> scaled(const Matrix3<T>& f) {
  using L = Limits<T>;
  const T size = largest_entry(f);
  const T first = size < L::kTiny ? L::kHuge : (size > L::kHuge ? L::kTiny : T(1));
  const T second = is_ordinary(f) ? T(1) : T(1) / (size * first);
  Matrix3<T> g;
  for (int k = 0; k < 9; ++k) g.m[k] = f.m[k] * first * second;
  return g;
}

// The rotation that maximises tr(RᵀF) is the unit quaternion q that maximises qᵀK(F)q, with
//
//   K(F) = [ tr F        aᵀ         ]     a = (F₂₁ - F₁₂, F₀₂ - F₂₀, F₁₀ - F₀₁)
//          [  a    F + Fᵀ - (tr F)I ]
//
// (B. K. P. Horn, "Closed-form solution of absolute orientation using unit quaternions", J. Opt.
// Soc. Am. A 4, 1987). Its eigenvalues are σ₁+σ₂+σ₃ ≥ σ₁-σ₂-σ₃ ≥ σ₂-σ₁-σ₃ ≥ σ₃-σ₁-σ₂, where
// σ₁ ≥ σ₂ ≥ |σ₃| are the singular values and σ₃ has the sign of det F. So the best rotation is
// unique where σ₂ + σ₃ > 0.
//
// In the frame of a rotation R near it, with M = RᵀF, the quaternion is (1, y) and the eigenvalue
// tr M + δ, where with B = 2(tr M)I - M - Mᵀ
//
//   (B + δI) y = a,    δ = a·y.
//
// If B + δI is positive definite, then by Cauchy's interlacing tr M + δ is above every eigenvalue
// but the largest: no other root is near, and the maximiser is certain. The secular function
// δ - aᵀ(B + δI)⁻¹a is increasing and concave there, so that Newton's steps on it,
//
//   δ ← δ + (a·y - δ) / (1 + y·y),
//
// converge from δ = 0 without overshooting. They are Rayleigh quotient iteration: δ's error is
// squared while the quaternion's is cubed. Differences of nearly equal numbers occur in `a` alone,
// where they are relative to |F| and not to the angle: near the identity nothing is lost.
template <typename T>
struct Frame {
  T a0, a1, a2;
  T b00, b11, b22, b01, b02, b12;
};

/// `m` = RᵀF.
template <typename T>
PLIANT_HOST_DEVICE inline Frame<T> make_frame(const Matrix3<T>& m) {
  Frame<T> frame;
  frame.a0 = m(2, 1) - m(1, 2);
  frame.a1 = m(0, 2) - m(2, 0);
  frame.a2 = m(1, 0) - m(0, 1);
  frame.b00 = T(2) * (m(1, 1) + m(2, 2));
  frame.b11 = T(2) * (m(0, 0) + m(2, 2));
  frame.b22 = T(2) * (m(0, 0) + m(1, 1));
  frame.b01 = -(m(0, 1) + m(1, 0));
  frame.b02 = -(m(0, 2) + m(2, 0));
  frame.b12 = -(m(1, 2) + m(2, 1));
  return frame;
}

template <typename T>
struct Root {
  T y0, y1, y2;
  T increment;     ///< of δ
  bool certain;    ///< B + δI is positive definite, beyond doubt by round-off
  bool converged;  ///< another solve would not change y
  bool accurate;   ///< another frame would not change the rotation
};

/// One solve at δ = `delta`; y is corrected to first order for the increment of δ.
template <typename T>
PLIANT_HOST_DEVICE inline Root<T> solve_secular(const Frame<T>& f, T delta) {
  const T b00 = f.b00 + delta, b11 = f.b11 + delta, b22 = f.b22 + delta;
  const T c00 = b11 * b22 - f.b12 * f.b12;
  const T c11 = b00 * b22 - f.b02 * f.b02;
  const T c22 = b00 * b11 - f.b01 * f.b01;
  const T c01 = f.b02 * f.b12 - f.b01 * b22;
  const T c02 = f.b01 * f.b12 - f.b02 * b11;
  const T c12 = f.b01 * f.b02 - b00 * f.b12;
  const T det = b00 * c00 + (f.b01 * c01 + f.b02 * c02);
  const T trace = b00 + (b11 + b22);
  const T inverse = T(1) / det;
  const T y0 = (c00 * f.a0 + c01 * f.a1 + c02 * f.a2) * inverse;
  const T y1 = (c01 * f.a0 + c11 * f.a1 + c12 * f.a2) * inverse;
  const T y2 = (c02 * f.a0 + c12 * f.a1 + c22 * f.a2) * inverse;
  const T ay = f.a0 * y0 + (f.a1 * y1 + f.a2 * y2);
  const T yy = y0 * y0 + (y1 * y1 + y2 * y2);

  Root<T> root;
  root.increment = (ay - delta) / (T(1) + yy);
  // dy/dδ = -(B + δI)⁻¹ y
  const T correction = root.increment * inverse;
  root.y0 = y0 - (c00 * y0 + c01 * y1 + c02 * y2) * correction;
  root.y1 = y1 - (c01 * y0 + c11 * y1 + c12 * y2) * correction;
  root.y2 = y2 - (c02 * y0 + c12 * y1 + c22 * y2) * correction;
  // The determinant's round-off is a few ε scale³, where `scale` counts what cancels in B, too. A
  // bound far above that leaves y many digits: as many as det has.
  const T scale = (std::abs(b00) + std::abs(b11) + std::abs(b22)) +
                  (std::abs(f.a0) + std::abs(f.a1) + std::abs(f.a2));
  const T size = std::abs(y0) + std::abs(y1) + std::abs(y2);
  root.certain = (b00 > T(0)) & (c22 > T(0)) &
                 (det > T(0.25) * Limits<T>::kRootEpsilon * (scale * scale * scale));
  // What the correction leaves is |y| (increment/β)², with β ≥ 4 det/trace² the least eigenvalue of
  // B + δI; round-off in M alone leaves ε trace/β.
  root.converged =
      root.increment * root.increment * (size * trace) <= T(0.5) * Limits<T>::kEpsilon * det;
  root.accurate = size * (trace * trace * trace) <= T(64) * det;
  return root;
}

template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> normalised(const Quaternion<T>& q) {
  return (T(1) / std::sqrt(dot(q, q))) * q;
}

/// The root for δ from 0; false where the start is too far away or F hardly determines a rotation.
template <typename T>
PLIANT_HOST_DEVICE inline bool find_root(const Frame<T>& frame, Root<T>& root) {
  T delta = T(0);
  for (int k = 0; k < kMaxSolves; ++k) {
    root = solve_secular(frame, delta);
    if (!root.certain) return false;
    if (root.converged) return true;
    delta += root.increment;
  }
  return false;
}

/// q, of length 1 to 2, becomes the best rotation for F; false, with q of no use, where the start
/// is too far away or F hardly determines a rotation.
template <typename T>
PLIANT_HOST_DEVICE inline bool refine(const Matrix3<T>& f, Quaternion<T>& q) {
  for (int k = 0; k < kMaxFrames; ++k) {
    Root<T> root;
    if (!find_root(make_frame(transpose_times(to_matrix(q), f)), root)) return false;
    q = normalised(q * Quaternion<T>{T(1), root.y0, root.y1, root.y2});
    if (root.accurate) return true;
  }
  return false;
}

}  // namespace pliant::rotation_detail
