#pragma once

#include <Eigen/Core>

/// Eigenvalues of symmetric matrices of any size, by Eigen: compiled once, which takes it seconds.
namespace pliant {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< rising
  Eigen::MatrixXd vectors;  ///< a column each, orthonormal
};

/// Of `a`, n x n, of which the lower half is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// Rising, without the vectors.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& a);

/// Of the matrix with the `diagonal` (n) and, to both sides of it, the numbers of `beside` (n - 1).
Eigen::VectorXd tridiagonal_eigenvalues(const Eigen::VectorXd& diagonal,
                                        const Eigen::VectorXd& beside);

}  // namespace pliant
