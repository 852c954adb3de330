#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pliant/core/body/particles.h"

namespace pliant {

/// A piece of yarn: a = Σ w x over its particles, whose length at rest is `length`. An edge of a
/// grid, or what warp or weft becomes within a triangle.
struct Yarn {
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

/// A path between neighbours along warp and weft.
struct ClothEdge {
  int i, j;
  double length;  ///< along yarns, at rest [m]
};

/// A capability of element sets: theirs are the yarns of a cloth.
class HasYarns {
 public:
  virtual ~HasYarns() = default;
  virtual void add_yarns(std::vector<Yarn>& yarns) const = 0;
  virtual void add_edges(std::vector<ClothEdge>& edges) const = 0;
  /// Adds each yarn's strain to its particles in `sum`, and 1 to them in `count`.
  virtual void add_strains(const Positions& x, Eigen::VectorXd& sum,
                           Eigen::VectorXd& count) const = 0;
};

}  // namespace pliant
