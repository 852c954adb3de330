#pragma once

#include <cmath>

#include "pliant/math/vector_traits.h"

/// Signed distances of shapes from a point p in the shape's frame, and the unit vectors along which
/// they grow. Where the nearest point is not the only one, one of them is chosen.
namespace pliant {

template <class V>
struct ShapeDistance {
  NumberOf<V> distance;  ///< < 0 inside [m]
  V normal;
};

namespace shapes_detail {

template <typename T>
PLIANT_HOST_DEVICE inline T sign(T x) {
  return x < T(0) ? T(-1) : T(1);
}

template <class V>
PLIANT_HOST_DEVICE inline V axis(int k) {
  using T = NumberOf<V>;
  return {k == 0 ? T(1) : T(0), k == 1 ? T(1) : T(0), k == 2 ? T(1) : T(0)};
}

template <class V>
PLIANT_HOST_DEVICE inline V absolute(const V& p) {
  return {std::fabs(p[0]), std::fabs(p[1]), std::fabs(p[2])};
}

template <class V>
PLIANT_HOST_DEVICE inline V without_negatives(const V& p) {
  using T = NumberOf<V>;
  return {greater(p[0], T(0)), greater(p[1], T(0)), greater(p[2], T(0))};
}

/// Of what is round about a point or a line: from that.
template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> round(const V& from_axis, NumberOf<V> radius,
                                                 int any_axis) {
  const auto r = VectorTraits<V>::length(from_axis);
  if (r < kNoDirection<NumberOf<V>>) return {r - radius, axis<V>(any_axis)};
  return {r - radius, from_axis / r};
}

}  // namespace shapes_detail

/// What is below z = 0.
template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> distance_to_plane(const V& p) {
  return {p[2], shapes_detail::axis<V>(2)};
}

template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> distance_to_sphere(const V& p, NumberOf<V> radius) {
  return shapes_detail::round(p, radius, 2);
}

/// `half`: half its sides.
template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> distance_to_box(const V& p, const V& half) {
  using namespace shapes_detail;
  using T = NumberOf<V>;
  const V beyond = absolute(p) - half;
  const V outside = without_negatives(beyond);
  const T distance = VectorTraits<V>::length(outside);
  if (distance > kNoDirection<T>) {
    const V normal = outside / distance;
    return {distance, {sign(p[0]) * normal[0], sign(p[1]) * normal[1], sign(p[2]) * normal[2]}};
  }
  int face = 2;
  if (beyond[1] > beyond[face]) face = 1;
  if (beyond[0] > beyond[face]) face = 0;
  return {beyond[face], sign(p[face]) * axis<V>(face)};
}

/// About z; its round ends are centred at ± `half_length`.
template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> distance_to_capsule(const V& p, NumberOf<V> radius,
                                                               NumberOf<V> half_length) {
  using namespace shapes_detail;
  using T = NumberOf<V>;
  const T beyond = greater(std::fabs(p[2]) - half_length, T(0));
  return round(V{p[0], p[1], sign(p[2]) * beyond}, radius, 0);
}

/// About z.
template <class V>
PLIANT_HOST_DEVICE inline ShapeDistance<V> distance_to_cylinder(const V& p, NumberOf<V> radius,
                                                                NumberOf<V> half_length) {
  using namespace shapes_detail;
  using T = NumberOf<V>;
  const T r = std::sqrt(p[0] * p[0] + p[1] * p[1]);
  const V radial = r < kNoDirection<T> ? axis<V>(0) : V{p[0] / r, p[1] / r, T(0)};
  const V axial = sign(p[2]) * axis<V>(2);
  const T side = r - radius, end = std::fabs(p[2]) - half_length;
  if (side > T(0) && end > T(0)) {
    const T distance = std::sqrt(side * side + end * end);
    if (distance > kNoDirection<T>) return {distance, (side * radial + end * axial) / distance};
  }
  return end >= side ? ShapeDistance<V>{end, axial} : ShapeDistance<V>{side, radial};
}

}  // namespace pliant
