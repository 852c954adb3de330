#include "pliant/geometry/distance/smooth_shapes.h"

#include <algorithm>

namespace pliant {

double round_cone(const Eigen::Vector3d& p, const Eigen::Vector3d& from, double from_radius,
                  const Eigen::Vector3d& to, double to_radius) {
  const Eigen::Vector3d axis = to - from;
  const double share = std::clamp(axis.dot(p - from) / axis.squaredNorm(), 0.0, 1.0);
  return (p - from - share * axis).norm() - (from_radius + share * (to_radius - from_radius));
}

double rounded_box(const Eigen::Vector3d& p, const Eigen::Vector3d& center,
                   const Eigen::Vector3d& half, double radius) {
  const Eigen::Array3d out = (p - center).array().abs() - (half.array() - radius);
  return out.max(0.0).matrix().norm() + std::min(out.maxCoeff(), 0.0) - radius;
}

double blended(double a, double b, double width) {
  // A parabola between both where they differ by less than the width.
  const double share = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - 0.25 * width * share * share;
}

}  // namespace pliant
