#pragma once

#include <cmath>
#include <type_traits>

#include "pliant/math/host_device.h"

namespace pliant {

/// A plain vector, alike on CPU and GPU: the same bits on both, where neither contracts products
/// and sums. T is a number of double or single precision.
template <typename T>
struct Vector3 {
  T x, y, z;

  PLIANT_HOST_DEVICE T operator[](int k) const { return k == 0 ? x : (k == 1 ? y : z); }

  PLIANT_HOST_DEVICE friend Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  PLIANT_HOST_DEVICE friend Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  PLIANT_HOST_DEVICE friend Vector3 operator*(T s, const Vector3& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  /// In single precision by way of 1/s: three divisions would take a GPU three times as long.
  PLIANT_HOST_DEVICE friend Vector3 operator/(const Vector3& a, T s) {
    if constexpr (std::is_same_v<T, float>) {
      return (1.0f / s) * a;
    } else {
      return {a.x / s, a.y / s, a.z / s};
    }
  }
  PLIANT_HOST_DEVICE friend Vector3& operator+=(Vector3& a, const Vector3& b) { return a = a + b; }
  PLIANT_HOST_DEVICE friend Vector3& operator-=(Vector3& a, const Vector3& b) { return a = a - b; }
  PLIANT_HOST_DEVICE friend T dot(const Vector3& a, const Vector3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  PLIANT_HOST_DEVICE friend T squared_norm(const Vector3& a) { return dot(a, a); }
  PLIANT_HOST_DEVICE friend T norm(const Vector3& a) { return std::sqrt(dot(a, a)); }
  PLIANT_HOST_DEVICE friend Vector3 cross(const Vector3& a, const Vector3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

using Float3 = Vector3<float>;
using Double3 = Vector3<double>;

/// Of std::min and std::max, which kernels cannot call: the first one unless the second is less
/// (larger), so that what is no number stays where it stood first.
template <typename T>
PLIANT_HOST_DEVICE inline T lesser(T a, T b) {
  return b < a ? b : a;
}
template <typename T>
PLIANT_HOST_DEVICE inline T greater(T a, T b) {
  return a < b ? b : a;
}
template <typename T>
PLIANT_HOST_DEVICE inline T clamped(T value, T low, T high) {
  return value < low ? low : (high < value ? high : value);
}

/// As long as 1; zero stays zero.
PLIANT_HOST_DEVICE inline Double3 normalized(const Double3& a) {
  const double squared = squared_norm(a);
  return squared > 0.0 ? a / std::sqrt(squared) : a;
}
/// The same where its square would be too small or too large for a number.
PLIANT_HOST_DEVICE inline Double3 stable_normalized(const Double3& a) {
  const double most = greater(greater(std::fabs(a.x), std::fabs(a.y)), std::fabs(a.z));
  const double squared = squared_norm(a / most);
  return squared > 0.0 ? a / (std::sqrt(squared) * most) : a;
}

}  // namespace pliant
