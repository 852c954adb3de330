#pragma once

#include <functional>

#include "pliant/core/system/constraint.h"

namespace pliant {

/// Acts on a 3 x n matrix in place.
using LinearOperator = std::function<void(Eigen::Matrix3Xd&)>;

/// The correction of all particles at once that respects what constraints hold:
///   d = argmin 1/2 dᵀP d − dᵀr + 1/2 (J d − c)ᵀC⁻¹(J d − c),
/// by conjugate gradients on (J P⁻¹ Jᵀ + C) μ = J P⁻¹ r − c, preconditioned by J P Jᵀ (the lumped
/// preconditioner of FETI, Farhat and Roux 1991): P is factored once, however contacts change.
class EqualityConstrainedCorrection {
 public:
  /// `d` holds r [N], 0 for a fixed particle, and becomes d [m].
  void solve(const ConstraintRows& rows, const Particles& particles, const LinearOperator& p,
             const LinearOperator& p_inverse, Eigen::Matrix3Xd& d);
  /// What the conditions may keep of their residual, as a share.
  void set_accuracy(double share) { accuracy_ = share; }
  int iterations() const { return iterations_; }  ///< of the last solve

 private:
  /// A number for each row.
  using RowVector = Eigen::Ref<Eigen::VectorXd>;

  void reserve(int rows);
  void normalise(const ConstraintRows& rows, const Particles& particles);
  void spread(const ConstraintRows& rows, const Particles& particles, const RowVector& mu);
  void gather(const ConstraintRows& rows, const Eigen::Matrix3Xd& d, RowVector mu) const;

  // A correction is one of many, and the next one takes up what it leaves open: errors of steps are
  // the same with a share a hundred times smaller.
  double accuracy_ = 1e-3;
  int iterations_ = 0;
  // At least as long as there are rows: their number changes with every contact.
  Eigen::VectorXd scale_;       // makes each row's gradient one of length 1
  Eigen::VectorXd compliance_;  // of the scaled rows
  Eigen::VectorXd residual_, preconditioned_, direction_, product_;
  Eigen::Matrix3Xd moved_;  // Jᵀ mu, then P or P⁻¹ of it
};

}  // namespace pliant
