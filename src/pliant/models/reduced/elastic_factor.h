#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "pliant/solvers/linear/pair_cholesky.h"

namespace pliant {

/// The factor of a symmetric, positive definite matrix between vertices, 3n x 3n, in blocks of two
/// vertices each, which keeps wide registers busy.
class ElasticFactor {
 public:
  /// Throws InputError for a matrix that is not positive definite.
  explicit ElasticFactor(const Eigen::SparseMatrix<double>& matrix);
  /// A⁻¹ b, of 3n numbers. Not by several threads at a time.
  Eigen::VectorXd solve(const Eigen::Ref<const Eigen::VectorXd>& b) const;

 private:
  mutable PairCholesky factor_;
  mutable Eigen::Matrix3Xd right_, left_;
};

}  // namespace pliant
