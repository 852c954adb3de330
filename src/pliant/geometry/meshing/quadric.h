#pragma once

#include <Eigen/Core>

namespace pliant {

/// Coefficients of a quadric: Q(p) = c0 x² + c1 y² + c2 z² + c3 xy + c4 yz + c5 zx + c6 x + c7 y +
/// c8 z + c9.
using Quadric = Eigen::Matrix<double, 10, 1>;

/// The row whose product with the coefficients is Q(p).
inline Eigen::Matrix<double, 1, 10> monomials(const Eigen::Vector3d& p) {
  const double x = p[0], y = p[1], z = p[2];
  Eigen::Matrix<double, 1, 10> row;
  row << x * x, y * y, z * z, x * y, y * z, z * x, x, y, z, 1.0;
  return row;
}

inline double value(const Quadric& c, const Eigen::Vector3d& p) {
  const double x = p[0], y = p[1], z = p[2];
  return (c[0] * x + c[3] * y + c[6]) * x + (c[1] * y + c[4] * z + c[7]) * y +
         (c[2] * z + c[5] * x + c[8]) * z + c[9];
}

inline Eigen::Vector3d gradient(const Quadric& c, const Eigen::Vector3d& p) {
  const double x = p[0], y = p[1], z = p[2];
  return {2.0 * c[0] * x + c[3] * y + c[5] * z + c[6], 2.0 * c[1] * y + c[3] * x + c[4] * z + c[7],
          2.0 * c[2] * z + c[4] * y + c[5] * x + c[8]};
}

/// The quadric Q'(p) = Q((p - origin) / scale).
Quadric placed(const Quadric& c, const Eigen::Vector3d& origin, double scale);

}  // namespace pliant
