#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace pliant {

/// The warp of a piece of cloth with that unit normal: the part of `direction` (a unit vector) that
/// lies in its plane, as a unit vector. Where that part is shorter than a tenth, the direction with
/// its axes moved on, x to y to z to x, takes its place: a yarn cannot leave its cloth.
inline Eigen::Vector3d warp_within(const Eigen::Vector3d& direction,
                                   const Eigen::Vector3d& normal) {
  constexpr double kLeastShare = 0.1;
  const auto within = [&](const Eigen::Vector3d& v) { return (v - normal * normal.dot(v)).eval(); };
  const Eigen::Vector3d first = within(direction);
  if (first.norm() >= kLeastShare) return first.normalized();
  return within({direction.z(), direction.x(), direction.y()}).normalized();
}

}  // namespace pliant
