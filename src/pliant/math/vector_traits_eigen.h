#pragma once

#include <Eigen/Geometry>

#include "pliant/math/vector_traits.h"

namespace pliant {

template <>
struct VectorTraits<Eigen::Vector3d> {
  using Vector = Eigen::Vector3d;
  using Number = double;
  static double length(const Vector& a) { return a.norm(); }
  static bool has_direction(const Vector& a) { return !a.isZero(0.0); }
  static Vector direction(const Vector& a) { return a.stableNormalized(); }
  static Vector cross_product(const Vector& a, const Vector& b) { return a.cross(b); }
};

}  // namespace pliant
