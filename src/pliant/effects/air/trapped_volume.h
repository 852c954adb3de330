#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/effects/air/column_volume.h"

namespace pliant {

/// Where each vertex of a piece of cloth would lie on the nearest of some obstacles.
struct FootPoints {
  bool are_flat = false;     ///< on `ground`, a plane: places and normals are not set
  Ground ground;             ///< of flat ones
  ColumnVolume column;       ///< above flat ones
  Eigen::Matrix3Xd places;   ///< on the surface that lying vertices are on [m]
  Eigen::Matrix3Xd normals;  ///< of it, unit
  Eigen::VectorXd heights;   ///< above it, 0 for what lies on it or is below [m]
  std::vector<int> nearest;  ///< obstacle

  Eigen::Vector3d normal(int i) const {
    return are_flat ? ground.normal : Eigen::Vector3d(normals.col(i));
  }
};

/// What cloth is sealed on: the nearest of some obstacles, of their surfaces `offset` outwards.
class FootFinder {
 public:
  /// `chosen` are numbers of obstacles, which outlive this.
  FootFinder(const std::vector<Obstacle>& obstacles, std::vector<int> chosen);

  /// With the obstacles where they are when the running step ends.
  void find(const Positions& x, double offset, FootPoints& foot_points) const;
  const std::vector<int>& chosen() const { return chosen_; }

 private:
  const std::vector<Obstacle>& obstacles_;
  std::vector<int> chosen_;
  bool is_plane_;
};

/// Volume between triangles and their foot points, positive where their normals lead away from
/// these [m³]; `x` may have moved since the foot points were found. Over a plane it is a
/// ColumnVolume; else it is the sum of prisms with bilinear sides: with dᵢ = xᵢ − qᵢ and edges e(s)
/// at the share s of the rise,
///   V = 1/2 ∫₀¹ e₁(s) × e₂(s) ds · Σ sᵢ dᵢ, with the shares sᵢ of the corners.
/// Sides that neighbours share cancel, so that it is exact but for what foot points and cloth lose
/// by being flat within a triangle. What is below its foot counts as on it.
double trapped_volume(const CoverTriangles& triangles, const Positions& x, FootPoints& foot_points);

/// How much of that volume is cloth, where layers of it keep a `thickness` t [m] between their
/// middles and the triangles are the middle: its inner face is t/2 below, so that
///   V_inner = V − t/2 (A − A_p),  A the area of the cloth and A_p that of its foot points,
///   negative where
/// it is folded over. 0 where cloth lies or is lifted flat, all of V for a fin of two layers that
/// touch. Of first order in the thickness times the curvature [m³].
double layer_volume(const Eigen::Matrix3Xi& triangles, const Positions& x,
                    const FootPoints& foot_points, double thickness);

/// dV/dx, 3 x n [m²]. Over a plane that of the ColumnVolume; else each corner's share of a
/// triangle's area along its normal, which is what a pressure acts on.
void trapped_volume_gradient(const CoverTriangles& triangles, const Positions& x,
                             FootPoints& foot_points, Eigen::Matrix3Xd& gradient);

}  // namespace pliant
