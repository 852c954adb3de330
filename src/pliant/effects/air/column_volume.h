#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "pliant/core/body/particles.h"
#include "pliant/effects/air/cover_triangles.h"

namespace pliant {

/// Half-space under which air is trapped: points with normal . x = level are on it.
struct Ground {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double level = 0.0;  ///< [m]
  double height(const Eigen::Vector3d& x) const { return std::max(0.0, normal.dot(x) - level); }
};

/// Heights of all particles above the ground [m].
void heights_above(const Positions& x, const Ground& ground, Eigen::VectorXd& heights);

/// Volume between a surface and the ground, V = sum_t (U . N_t) A_t h_t with the mean height h_t of
/// a triangle's corners, by their shares, folded-over triangles negative (Yamada 2013, eq. 3.10,
/// with thirds). Heights below the ground count as zero. It works in coordinates of the ground, and
/// keeps what it needs for many volumes of the same vertices.
class ColumnVolume {
 public:
  void place(const Positions& x, const Ground& ground);
  double volume(const CoverTriangles& triangles) const;  ///< where they were placed [m³]
  /// dV/dx there, 3 x n [m²]; for particles on the ground it is the one-sided derivative upwards.
  void gradient(const CoverTriangles& triangles, Eigen::Matrix3Xd& gradient);
  /// Vertices may move by `mobility` times that gradient for each unit of pressure, and are then
  /// pulled back by `held` >= 0 [m], to the ground at the most; empty: none is.
  void release(const Eigen::VectorXd& mobility, const Eigen::VectorXd& held);
  /// Volume when they have so moved by a pressure change `delta` [Pa], and its derivative by that
  /// for the vertices that nothing below stops [m³/Pa].
  double volume_after(double delta, const CoverTriangles& triangles, double& slope);

 private:
  Ground ground_;
  // Of the ground's axes; the third is its normal.
  Eigen::Vector3d along_ = Eigen::Vector3d::Zero(), across_ = Eigen::Vector3d::Zero();
  // Coordinates and height that may be negative, for each vertex; a fourth number fills the line.
  Eigen::Matrix4Xd at_, rates_, moved_, derivative_;
  Eigen::VectorXd slopes_;  // of the volume, by vertex
  Eigen::VectorXd held_;    // back to the ground, by vertex [m]; empty: none is
};

/// The same for one place [m³].
double column_volume(const CoverTriangles& triangles, const Positions& x, const Ground& ground);

/// Likewise [m²], into `gradient`.
void column_volume_gradient(const CoverTriangles& triangles, const Positions& x,
                            const Ground& ground, Eigen::Matrix3Xd& gradient);

}  // namespace pliant
