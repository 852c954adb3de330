#pragma once

#include <type_traits>

#include "pliant/math/vector3.h"

namespace pliant {

/// Below this length the square of a vector leaves the range of numbers: it has no direction.
template <typename T>
constexpr T kNoDirection = std::is_same_v<T, float> ? T(1e-18) : T(1e-150);

/// What formulas that hold for several kinds of vectors need to know of one. Those of Eigen, whose
/// sums have an order of their own, are in vector_traits_eigen.h.
template <class V>
struct VectorTraits;

template <typename T>
struct VectorTraits<Vector3<T>> {
  using Vector = Vector3<T>;
  using Number = T;
  PLIANT_HOST_DEVICE static T length(const Vector& a) { return norm(a); }
  PLIANT_HOST_DEVICE static bool has_direction(const Vector& a) {
    return !(norm(a) < kNoDirection<T>);
  }
  PLIANT_HOST_DEVICE static Vector direction(const Vector& a) { return a / norm(a); }
  PLIANT_HOST_DEVICE static Vector cross_product(const Vector& a, const Vector& b) {
    return cross(a, b);
  }
};

template <class V>
using NumberOf = typename VectorTraits<V>::Number;

}  // namespace pliant
