#pragma once

#include <cmath>

#include "pliant/math/host_device.h"

namespace pliant {

/// A plain vector of double precision: the same bits on CPU and GPU, where neither contracts
/// products and sums. What is called with braces alone means single precision (cuda/core/vector.h),
/// so that its functions are friends.
struct Double3 {
  double x, y, z;

  PLIANT_HOST_DEVICE friend Double3 operator+(const Double3& a, const Double3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  PLIANT_HOST_DEVICE friend Double3 operator-(const Double3& a, const Double3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  PLIANT_HOST_DEVICE friend Double3 operator*(double s, const Double3& a) {
    return {s * a.x, s * a.y, s * a.z};
  }
  PLIANT_HOST_DEVICE friend Double3 operator/(const Double3& a, double s) {
    return {a.x / s, a.y / s, a.z / s};
  }
  PLIANT_HOST_DEVICE friend Double3& operator+=(Double3& a, const Double3& b) { return a = a + b; }
  PLIANT_HOST_DEVICE friend double dot(const Double3& a, const Double3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  PLIANT_HOST_DEVICE friend double squared_norm(const Double3& a) { return dot(a, a); }
  PLIANT_HOST_DEVICE friend double norm(const Double3& a) { return std::sqrt(dot(a, a)); }
  PLIANT_HOST_DEVICE friend Double3 cross(const Double3& a, const Double3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

/// Of std::min and std::max, which kernels cannot call: the first one unless the second is less
/// (larger), so that what is no number stays where it stood first.
PLIANT_HOST_DEVICE inline double lesser(double a, double b) { return b < a ? b : a; }
PLIANT_HOST_DEVICE inline double greater(double a, double b) { return a < b ? b : a; }
PLIANT_HOST_DEVICE inline double clamped(double value, double low, double high) {
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
