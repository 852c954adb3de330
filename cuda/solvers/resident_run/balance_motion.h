#pragma once

#include "cuda/core/vector.h"
#include "pliant/math/vector3.h"

namespace pliant {

PLIANT_HOST_DEVICE inline Double3 in_double(const Float3& v) { return Double3{v.x, v.y, v.z}; }
PLIANT_HOST_DEVICE inline Float3 in_single(const Double3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
/// In quanta, without rounding.
PLIANT_HOST_DEVICE inline Double3 difference(const Fixed& a, const Fixed& b) {
  return Double3{static_cast<double>(a.x) - b.x, static_cast<double>(a.y) - b.y,
                 static_cast<double>(a.z) - b.z};
}
/// By a `displacement` in quanta of more digits than single precision has. What is no number
/// becomes one that no bound lets pass.
PLIANT_HOST_DEVICE inline Fixed moved_far(const Fixed& from, const Double3& displacement) {
  const auto whole = [](double value) {
    constexpr double kMost = 1073741824.0;
    if (!(value > -kMost)) return -1073741824;
    return value < kMost ? static_cast<int>(rint(value)) : 1073741824;
  };
  return {from.x + whole(displacement.x), from.y + whole(displacement.y),
          from.z + whole(displacement.z), from.w};
}

/// A rigid motion of a component about its centre of mass.
struct BalanceMotion {
  Fixed origin;    ///< where its first member was when the step began
  Double3 center;  ///< from there [m]
  Double3 shift;   ///< [m]
  Double3 turn;    ///< [rad]

  /// From the centre to a particle at `x` [m].
  PLIANT_HOST_DEVICE Double3 arm(const Fixed& x, double quantum) const {
    return quantum * difference(x, origin) - center;
  }
  /// Of a point at `arm` from the centre, where the turn is small [m].
  PLIANT_HOST_DEVICE Double3 of(const Double3& arm) const { return shift + cross(turn, arm); }
  /// However far it turns [m].
  PLIANT_HOST_DEVICE Double3 far(const Double3& arm) const {
    constexpr double kSmall = 1e-8;
    const double angle = norm(turn);
    const Double3 once = cross(turn, arm);
    if (angle < kSmall) return shift + once;
    return shift + (std::sin(angle) / angle) * once +
           ((1.0 - std::cos(angle)) / (angle * angle)) * cross(turn, once);
  }
};

}  // namespace pliant
