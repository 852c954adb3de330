#pragma once

#include <Eigen/Core>

namespace pliant {

/// Eigenvalues, rising, and orthonormal eigenvectors, a column each, of a symmetric matrix.
struct SymmetricEigen3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};

/// Of `a`, finite, of which the lower half is read; exact but for round-off of the largest
/// eigenvalue. By closed form, which gives half of the digits where eigenvalues are close, and a
/// sweep of Jacobi's rotations, which doubles them: 0.7 of the time of iterations from the
/// start.
SymmetricEigen3 symmetric_eigen3(const Eigen::Matrix3d& a);

}  // namespace pliant
