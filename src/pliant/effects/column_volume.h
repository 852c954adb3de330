#pragma once

#include <Eigen/Core>

#include "pliant/core/particles.h"

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
/// a triangle's corners, folded-over triangles negative (Yamada 2013, eq. 3.10) [m³]. Heights below
/// the ground count as zero.
double column_volume(const Eigen::Matrix3Xi& triangles, const Positions& x, const Ground& ground);

/// The same with `heights` that heights_above() gave for `x`.
double column_volume(const Eigen::Matrix3Xi& triangles, const Positions& x,
                     const Eigen::VectorXd& heights, const Eigen::Vector3d& up);

/// dV/dx, 3 x n [m²], into `gradient`; for particles on the ground it is the one-sided derivative
/// upwards.
void column_volume_gradient(const Eigen::Matrix3Xi& triangles, const Positions& x,
                            const Ground& ground, Eigen::Matrix3Xd& gradient);

}  // namespace pliant
