#pragma once

#include <vector>

#include "pliant/effects/strain_limit/linear_constraints.h"
#include "pliant/math/dense_factors.h"
#include "pliant/solvers/linear/cholesky.h"

namespace pliant {

/// Conditions that a projection of all yarns has to keep: of few rows, so that each iteration
/// meets them by the factor's solution for each row (Woodbury).
class YarnConstraints {
 public:
  /// Takes conditions on a displacement from where `moved` has come to. Factor and `inertia`, 0
  /// where nothing moves, are in units of `scale` [N/m].
  void take(const LinearConstraints& conditions, const Eigen::VectorXd& inertia, double scale,
            const Eigen::Matrix3Xd& moved, CholeskySolver& factor);
  /// Moves a solution of the factor to one that keeps them.
  void apply(Eigen::Matrix3Xd& moved);
  /// x[i] += mobility[i] x force.
  void add_forces(const Eigen::VectorXd& mobility, Positions& x) const;
  /// By how much the multiplier of condition k changes.
  double change(std::size_t k) const { return scale_ * multipliers_[static_cast<Eigen::Index>(k)]; }

 private:
  struct Row {
    std::vector<LinearConstraint::Entry> entries;
    double target, least, most;
    Eigen::Matrix3Xd response;  // of all particles to a unit of its multiplier
    double of(const Eigen::Matrix3Xd& moved) const;
  };
  void add_row(const LinearConstraint& condition, const Eigen::VectorXd& inertia,
               const Eigen::Matrix3Xd& moved, CholeskySolver& factor);

  // Of the rows the first `count_` are in use, and as much of what is as large as they are many:
  // that so many were once needs no memory when they are fewer. The rest of the matrix is the
  // unit's.
  std::vector<Row> rows_;
  std::size_t count_ = 0;
  double scale_ = 1.0;
  Eigen::MatrixXd responses_;  // of each row to each
  DenseLdlt inverse_;
  Eigen::VectorXd multipliers_, missed_;
};

}  // namespace pliant
