#pragma once

#include <Eigen/Core>
#include <Eigen/LU>

namespace pliant {

/// Barycentric coordinates of a tetrahedron as functions of place; not finite for a flat one.
struct Barycentric {
  Eigen::Vector3d origin;                 ///< corner 0 [m]
  Eigen::Matrix<double, 4, 3> gradients;  ///< a coordinate each row [1/m]

  explicit Barycentric(const Eigen::Matrix<double, 3, 4>& corners) : origin(corners.col(0)) {
    const Eigen::Matrix3d sides = corners.rightCols<3>().colwise() - origin;
    gradients.bottomRows<3>() = sides.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
  }
  Eigen::Vector4d operator()(const Eigen::Vector3d& at) const {
    return Eigen::Vector4d::UnitX() + gradients * (at - origin);
  }
};

/// The columns of `x` that a tetrahedron names.
inline Eigen::Matrix<double, 3, 4> corners_of(const Eigen::Matrix3Xd& x,
                                              const Eigen::Vector4i& tetrahedron) {
  Eigen::Matrix<double, 3, 4> corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = x.col(tetrahedron[k]);
  return corners;
}

/// Barycentric coordinates of a place on a triangle, whose corners are columns; not finite on one
/// without area.
inline Eigen::Vector3d triangle_weights(const Eigen::Matrix3d& corners, const Eigen::Vector3d& at) {
  const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
  const Eigen::Vector3d p = at - corners.col(0);
  const double aa = a.squaredNorm(), ab = a.dot(b), bb = b.squaredNorm();
  const double det = aa * bb - ab * ab;
  const double v = (bb * p.dot(a) - ab * p.dot(b)) / det;
  const double w = (aa * p.dot(b) - ab * p.dot(a)) / det;
  return {1.0 - v - w, v, w};
}

}  // namespace pliant
