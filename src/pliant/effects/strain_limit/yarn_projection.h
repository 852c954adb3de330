#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/effects/strain_limit/yarn_constraints.h"
#include "pliant/effects/strain_limit/yarns.h"
#include "pliant/solvers/linear/cholesky.h"

namespace pliant {

/// Brings all yarns within their limits at once, however far apart what is held and what hangs
/// on it are: the alternating direction method of multipliers (Boyd et al. 2011, sec. 3; Overby et
/// al. 2017, "ADMM ⊇ projective dynamics") on
///   min 1/2 |x − y|²  in the norm of 1/mobility,  where |a_t(x)| <= max length_t,
/// y the positions that are given. Each iteration clips every yarn by itself and solves
/// (1/mobility + κ Aᵀ A) for all of them, A the yarns' weights: a matrix that does not change
/// with x and is factored once. Forces act in pairs. What else the yarns' final projection has to
/// keep are a few linear conditions, which each iteration meets.
class YarnProjection {
 public:
  /// Moves x[i] by mobility[i] x force, in up to `iterations`, fewer where no yarn is too long by
  /// more than `tolerance`, a share of its length, and all keepers are content. Factors where
  /// `mobility` differs from that of the last call by more than a common factor. Returns how many
  /// it took.
  int project(const Yarns& yarns, double max, const Eigen::VectorXd& mobility, int iterations,
              double tolerance, const std::vector<LinearConstraintProvider*>& keepers,
              Positions& x);

 private:
  /// Of a yarn: a at the start, v and z of the method, and what it pulls over κ, all in [m].
  struct State {
    Eigen::Vector3d start, v, z, pull;
  };
  void prepare(const Yarns& yarns, const Eigen::VectorXd& mobility);
  void begin(const Yarns& yarns, double max, const Positions& x);
  /// d from where every yarn wants to be.
  void solve(const Yarns& yarns);
  /// Every yarn at d by itself. Returns by how much one is too long at the most, as a share.
  double clip(const Yarns& yarns, double max);
  void add_pulls(const Yarns& yarns, const Eigen::VectorXd& mobility, Positions& x) const;

  /// Whether the keepers' conditions are met at y + d.
  bool keeps(const std::vector<LinearConstraintProvider*>& keepers, const Positions& y);
  /// Takes their conditions anew, at y + d.
  void ask(const std::vector<LinearConstraintProvider*>& keepers, const Positions& y);
  void tell_changes() const;

  CholeskySolver factor_;
  YarnConstraints conditions_;
  Eigen::VectorXd inertia_;  // the factor's 1/mobility over their scale; 0 where nothing moves
  double scale_ = 0.0;       // of 1/mobility [N/m]
  double stiffness_ = 0.0;   // κ over the scale
  std::vector<State> states_;
  Eigen::Matrix3Xd moved_;  // d = x − y [m]
  LinearConstraints asked_, asked_before_;
  Positions at_;  // y + d
};

}  // namespace pliant
