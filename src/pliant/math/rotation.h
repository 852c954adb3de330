#pragma once

#include "pliant/math/matrix3.h"
#include "pliant/math/rotation_robust.h"
#include "pliant/math/rotation_secular.h"
#include "pliant/math/rotation_start.h"

/// The proper rotation nearest to a 3x3 matrix: R with det R = +1 that maximises tr(RᵀF), the
/// rotation of the polar decomposition where det F > 0. The one place that computes it, for CPU and
/// GPU, in float and double. With arrays: rotation_batch.h; with Eigen: rotation_eigen.h.
namespace pliant {

namespace rotation_detail {

/// Round-off leaves unit quaternions well within this of their length.
template <typename T>
PLIANT_HOST_DEVICE inline bool about_unit(const Quaternion<T>& q) {
  const T excess = dot(q, q) - T(1);
  return (excess > T(-8) * Limits<T>::kEpsilon) & (excess < T(8) * Limits<T>::kEpsilon);
}

/// The identity where q is zero or not finite.
template <typename T>
PLIANT_RARE_PATH PLIANT_HOST_DEVICE Quaternion<T> unit_or_identity(const Quaternion<T>& q) {
  using L = Limits<T>;
  const T size = larger(larger(std::abs(q.w), std::abs(q.x)), larger(std::abs(q.y), std::abs(q.z)));
  const T first = size < L::kTiny ? L::kHuge : (size > L::kHuge ? L::kTiny : T(1));
  const Quaternion<T> p = (T(1) / (size * first)) * (first * q);
  const T squared_length = dot(p, p);  // 1 to 4, or NaN
  return squared_length > T(0.5) ? normalised(p) : Quaternion<T>::identity();
}

/// q and -q are the same rotation; the one nearer to `other`.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> on_side_of(const Quaternion<T>& q,
                                                   const Quaternion<T>& other) {
  return (dot(q, other) < T(0) ? T(-1) : T(1)) * q;
}

/// `f` scaled, `nearest` of unit length.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> rotation_without_start(const Matrix3<T>& f,
                                                               const Quaternion<T>& nearest) {
  Quaternion<T> q = cold_start(f);
  if (!refine(f, q)) q = robust_rotation(f, nearest);
  return on_side_of(q, nearest);
}

}  // namespace rotation_detail

/// Defined for every matrix: singular, reflected, zero, of any scale. The start saves time and
/// never changes the answer, however far away it is, where F determines one. Where F leaves the
/// rotation free (zero; rank one, about its axis; reflected, where the two smallest singular values
/// are equal), the best one nearest to `warm_start` is chosen. NaN or infinity in `f` gives
/// `warm_start` back. A `warm_start` not of unit length is normalised; zero, NaN and infinity mean
/// the identity.
///
/// Error, as an angle: a few ε |F| / (σ₂ + σ₃), where σ₃ has the sign of det F; a matrix rounded to
/// T determines it no better. The quaternion lies on the side of `warm_start`: q·warm_start ≥ 0.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> nearest_rotation(const Matrix3<T>& f,
                                                         const Quaternion<T>& warm_start) {
  using namespace rotation_detail;
  const Quaternion<T> start = about_unit(warm_start) ? warm_start : unit_or_identity(warm_start);
  const Matrix3<T> g = is_ordinary(f) ? f : scaled(f);
  Quaternion<T> q = start;
  if (refine(g, q)) return on_side_of(q, start);
  return rotation_without_start(g, start);
}

/// The part of it that is enough nearly always: from a unit quaternion `q` near it, the rotation;
/// false, with q of no use, where that is too far away or `f` hardly determines one.
template <typename T>
PLIANT_HOST_DEVICE inline bool refined_rotation(const Matrix3<T>& f, Quaternion<T>& q) {
  return rotation_detail::is_ordinary(f) && rotation_detail::refine(f, q);
}

/// Without a warm start, about twice the time; what `f` leaves free is near the identity.
template <typename T>
PLIANT_HOST_DEVICE inline Quaternion<T> nearest_rotation(const Matrix3<T>& f) {
  return rotation_detail::rotation_without_start(
      rotation_detail::is_ordinary(f) ? f : rotation_detail::scaled(f), Quaternion<T>::identity());
}

}  // namespace pliant
