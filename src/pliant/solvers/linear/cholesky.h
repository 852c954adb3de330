#pragma once

#include <Eigen/SparseCholesky>

#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {

/// A = P^T L L^T P, factored once and solved for x, y and z at the same time: one pass over the
/// factor serves three right-hand sides.
class CholeskySolver {
 public:
  /// Throws InputError when `a` is not positive definite to round-off.
  void factor(const SparseRows& a);
  /// b <- A^-1 b, b is 3 x n.
  void solve(Eigen::Matrix3Xd& b);
  /// Entries of L.
  Eigen::Index nonzeros() const { return factor_.nonZeros(); }

 private:
  Eigen::SparseMatrix<double> factor_;  // L, column by column, each one's diagonal entry first
  Eigen::VectorXi order_;               // row of L -> row of A
  Eigen::Matrix4Xd permuted_;           // of the three sides, and a row of zeros
};

}  // namespace pliant
