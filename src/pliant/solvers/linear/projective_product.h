#pragma once

#include <vector>

#include "pliant/core/system/shared_stiffness.h"
#include "pliant/solvers/linear/projective_matrix.h"

namespace pliant {

/// The matrix of projective_matrix() for those who ask for its products, diagonal and row sums
/// alone. What the particles of a cluster share is kept by cluster: of n particles in clusters of
/// m, each of them has some m² entries there, of which this has m.
class ProjectiveProduct {
 public:
  void assemble(const ProjectiveSystem& system, double dt);

  const Eigen::VectorXd& diagonal() const { return diagonal_; }  ///< [N/m]
  /// No less than the sums of a row's absolute entries [N/m].
  Eigen::VectorXd absolute_row_sums() const;
  /// y = A x.
  void multiply(const Eigen::VectorXd& x, Eigen::VectorXd& y) const;

  /// Whether anything is kept by cluster; else entries() is the whole matrix.
  bool shares() const { return !shared_.empty(); }
  const SparseRows& entries() const { return entries_; }

 private:
  SparseRows entries_;
  std::vector<SharedEntries> shared_;  // of members that are free
  Eigen::VectorXd diagonal_;
};

}  // namespace pliant
