#pragma once

#include "pliant/core/system.h"
#include "pliant/solvers/coarse_space.h"

namespace pliant {

/// Solves with the stiffness K of elastic bodies, an inertia and directions that are held,
///   (M/T² + K + Jᵀ S J) d = b,
/// by conjugate gradients with two levels: blocks on the diagonal, and a coarse space of rigid
/// pieces. The number of iterations hardly grows with size, slenderness and stiffness of a body.
class HessianSolver {
 public:
  /// The system's structure changed.
  void prepare() { is_prepared_ = false; }
  /// Takes K at the positions `x`, and `inertia` m/T² of each particle [N/m]. With kExact the
  /// matrix may turn out not to be positive definite.
  void assemble(const ProjectiveSystem& system, const Positions& x, const Eigen::VectorXd& inertia,
                Definiteness definiteness);
  /// J and S: factor() takes what they are then.
  HeldRows& rows() { return rows_; }
  void factor();

  /// `v` holds b [N], 0 for a pinned particle, and becomes d [m], until the residual is that share
  /// of b in the preconditioner's norm. False where the matrix is not positive definite.
  bool solve(double tolerance, Eigen::Matrix3Xd& v);
  /// y = (M/T² + K) v.
  void multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const { matrix_.multiply(v, y); }
  double blocks() const { return static_cast<double>(matrix_.end(matrix_.size() - 1)); }
  int iterations() const { return iterations_; }  ///< of the last solve

 private:
  void precondition(const Eigen::Matrix3Xd& r, Eigen::Matrix3Xd& z);

  Positions x_;  // of K
  BlockMatrix matrix_;
  HeldRows rows_;
  CoarseSpace coarse_;
  bool is_prepared_ = false;
  std::vector<Eigen::Matrix3d> inverses_;  // of the blocks on the diagonal
  Eigen::Matrix3Xd residual_, preconditioned_, direction_, product_;
  int iterations_ = 0;
};

}  // namespace pliant
