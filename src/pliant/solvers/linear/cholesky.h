#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

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
  Eigen::Index nonzeros() const { return nonzeros_; }

  /// Up to four neighbouring columns of L that have the same rows below them, which are read and
  /// written once for all of them.
  struct Panel {
    int column, width;       ///< the first one, and how many
    int first_row, rows;     ///< those below, in the list of all panels
    std::ptrdiff_t numbers;  ///< where its own begin, see values_
  };

 private:
  using Factor = Eigen::SparseMatrix<double>;
  void split(const Factor& factor);
  void add_panel(const Factor& factor, int column, int width);

  std::vector<Panel> panels_;
  std::vector<int> rows_;
  // Of each panel: one over each diagonal entry; the entries below the diagonal within the panel,
  // row by row; and those of each row below it, side by side.
  std::vector<double> values_;
  Eigen::Index nonzeros_ = 0;
  Eigen::VectorXi order_;      // row of L -> row of A
  Eigen::Matrix4Xd permuted_;  // of the three sides, and a row of zeros
};

}  // namespace pliant
