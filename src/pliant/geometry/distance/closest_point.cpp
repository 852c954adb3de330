#include "pliant/geometry/distance/closest_point.h"

#include "pliant/geometry/search/simplex_pair.h"

namespace pliant {

Eigen::Vector3d closest_point_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                          const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const auto plain = [](const Eigen::Vector3d& v) { return Double3{v[0], v[1], v[2]}; };
  const Double3 nearest = closest_on_triangle(plain(p), plain(a), plain(b), plain(c));
  return {nearest.x, nearest.y, nearest.z};
}

}  // namespace pliant
