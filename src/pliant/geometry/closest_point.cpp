#include "pliant/geometry/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace pliant {
namespace {

using Eigen::Vector3d;

Vector3d closest_point_on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d way = b - a;
  const double squared = way.squaredNorm();
  if (squared == 0.0) return a;
  return a + std::clamp(way.dot(p - a) / squared, 0.0, 1.0) * way;
}

}  // namespace

Vector3d closest_point_on_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                                   const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  // Barycentric coordinates of p's projection, times squared.
  const double at_a = (c - b).cross(p - b).dot(normal);
  const double at_b = (a - c).cross(p - c).dot(normal);
  const double at_c = (b - a).cross(p - a).dot(normal);
  if (squared > 0.0 && at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0) {
    return p - normal * (normal.dot(p - a) / squared);
  }
  const Vector3d candidates[] = {closest_point_on_segment(p, a, b),
                                 closest_point_on_segment(p, b, c),
                                 closest_point_on_segment(p, c, a)};
  return *std::min_element(std::begin(candidates), std::end(candidates),
                           [&p](const Vector3d& l, const Vector3d& r) {
                             return (l - p).squaredNorm() < (r - p).squaredNorm();
                           });
}

}  // namespace pliant
