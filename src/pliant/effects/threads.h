#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "pliant/core/element_set.h"
#include "pliant/effects/tethers.h"

namespace pliant {

/// A piece of yarn: a = Σ w x over its particles, whose length at rest is `length`. An edge of a
/// grid, or what warp or weft becomes within a triangle.
struct Thread {
  std::array<int, 3> particles;
  std::array<double, 3> weights;  ///< they sum to 0; the last is 0 for an edge
  double length;                  ///< [m]

  Eigen::Vector3d along(const Positions& x) const {
    const double* at = x.data();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      sum += weights[k] * Eigen::Map<const Eigen::Vector3d>(at + 3 * particles[k]);
    }
    return sum;
  }
};

/// Threads, colour by colour: those of one share no particle.
struct Threads {
  std::vector<Thread> all;
  std::vector<int> begins;  ///< first thread of each colour, and the end
};

/// Of the springs named `stretch` and the triangles of `elements`; maybe none.
Threads find_threads(const std::vector<std::unique_ptr<ElementSet>>& elements, int particles);

/// Ways between neighbours along warp and weft: what lies across them may shear to no more.
std::vector<ClothEdge> find_ways(const std::vector<std::unique_ptr<ElementSet>>& elements);

}  // namespace pliant
