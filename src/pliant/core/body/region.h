#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// Some of a body's particles: listed, or those that are within a box or a sphere of the world when
/// they are looked for.
struct Region {
  enum class Kind { kVertices, kBox, kSphere };
  Kind kind = Kind::kVertices;
  std::vector<int> vertices;                         ///< kVertices: indices
  Eigen::AlignedBox3d box;                           ///< kBox [m]
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< kSphere [m]
  double radius = 0.0;                               ///< kSphere [m]
};

/// Those of `count` particles, from `first` on, that are in `region`, whose listed vertices count
/// from `first`; its borders belong to it. Throws InputError for a listed vertex that is not among
/// them.
std::vector<int> particles_in(const Region& region, const Positions& x, int first, int count);

}  // namespace pliant
