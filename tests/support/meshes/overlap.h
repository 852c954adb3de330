#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "support/worlds/solid_world.h"

namespace pliant {

/// How deep a point lies within any of the tetrahedra: its least distance to a side of the one that
/// holds it best; not positive for a point outside [m].
inline double depth_within(const Eigen::Vector3d& point, const Positions& x,
                           const Eigen::Matrix4Xi& tetrahedra) {
  double deepest = -INFINITY;
  for (const auto t : tetrahedra.colwise()) {
    Eigen::Matrix4d corners;
    for (int k = 0; k < 4; ++k) corners.col(k) << x.col(t[k]), 1.0;
    const Eigen::Matrix4d inverse = corners.inverse();
    const Eigen::Vector4d weights = inverse * point.homogeneous();
    double least = INFINITY;
    for (int k = 0; k < 4; ++k) {
      least = std::min(least, weights[k] / inverse.row(k).head<3>().norm());
    }
    deepest = std::max(deepest, least);
  }
  return deepest;
}

/// Tetrahedra of one part.
inline Eigen::Matrix4Xi part_tetrahedra(const SolidModel& model, int part) {
  const Eigen::Matrix4Xi& all = model.tetrahedra()->tetrahedra;
  Eigen::Matrix4Xi own(4, 0);
  for (const auto t : all.colwise()) {
    if (t[0] < model.first(part) || t[0] >= model.first(part) + model.count(part)) continue;
    own.conservativeResize(4, own.cols() + 1);
    own.rightCols(1) = t;
  }
  return own;
}

/// The deepest that any vertex of one part lies within another part [m].
inline double deepest_overlap(const World& world) {
  const SolidModel& model = solid_of(world);
  const Positions& x = model.particles().x;
  double deepest = -INFINITY;
  for (int part = 0; part < model.parts(); ++part) {
    const Eigen::Matrix4Xi tetrahedra = part_tetrahedra(model, part);
    for (int i = 0; i < x.cols(); ++i) {
      if (i >= model.first(part) && i < model.first(part) + model.count(part)) continue;
      deepest = std::max(deepest, depth_within(x.col(i), x, tetrahedra));
    }
  }
  return deepest;
}

}  // namespace pliant
