#pragma once

#include <vector>

#include "pliant/effects/kept_conditions.h"
#include "pliant/solvers/cholesky.h"

namespace pliant {

/// Conditions that a projection of all threads has to keep: of few rows, so that each iteration
/// meets them by the factor's solution for each row (Woodbury).
class ThreadConditions {
 public:
  /// Takes conditions on a displacement from where `moved` has come to. Factor and `inertia`, 0
  /// where nothing moves, are in units of `scale` [N/m].
  void take(const std::vector<KeptCondition>& conditions, const Eigen::VectorXd& inertia,
            double scale, const Eigen::Matrix3Xd& moved, CholeskySolver& factor);
  /// Moves a solution of the factor to one that keeps them.
  void apply(Eigen::Matrix3Xd& moved);
  /// x[i] += mobility[i] x force.
  void add_forces(const Eigen::VectorXd& mobility, Positions& x) const;
  /// By how much each multiplier changes.
  Eigen::VectorXd changes() const { return scale_ * multipliers_; }

 private:
  struct Row {
    std::vector<int> particles;
    Eigen::Matrix3Xd gradient;
    double target, least, most;
    Eigen::Matrix3Xd response;  // of all particles to a unit of its multiplier
    double of(const Eigen::Matrix3Xd& moved) const;
  };
  std::vector<Row> rows_;
  double scale_ = 1.0;
  Eigen::MatrixXd responses_;  // of each row to each
  Eigen::VectorXd multipliers_, missed_;
};

}  // namespace pliant
