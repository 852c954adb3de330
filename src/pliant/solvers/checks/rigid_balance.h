#pragma once

#include "pliant/math/dense_factors.h"
#include "pliant/solvers/components/rigid_modes.h"
#include "pliant/solvers/constrained/held_rows.h"

namespace pliant {

/// The rigid motion that an inexact solution lacks of the connected components that nothing holds
/// from outside, so that forces that elements do not balance give them their momentum:
///   z = P (Pᵀ M P / T² + (J P)ᵀ S (J P))⁻¹ Pᵀ r,  r the equations' residual.
class RigidBalance {
 public:
  void prepare(const ProjectiveSystem& system, const Eigen::VectorXd& inertia) {
    prepare(find_components(system), inertia);
  }
  void prepare(Components components, const Eigen::VectorXd& inertia);
  /// Whether from the next place() on all components turn, whatever elements do.
  void let_all_turn(bool all_turn) { modes_.let_all_turn(all_turn); }
  /// Of the inertia `scale` times `mass` [N/m], at the positions `x`.
  void place(const Eigen::VectorXd& mass, double scale, const Positions& x);
  /// With the rows J, S from now on.
  void factor(const HeldRows& rows);
  /// `z` holds r [N] and becomes that motion [m]. False where there are no such
  /// components, or more than it is made for.
  bool find_motion(Eigen::Matrix3Xd& z);
  /// The same of forces and torques on each component, which become how it is shifted and turned.
  void find_motions(Eigen::VectorXd& sums) const { factor_.solve_in_place(sums); }
  const RigidModes& modes() const { return modes_; }
  /// Whether there are such components, and no more than it is made for.
  bool is_used() const { return modes_.count() > 0 && !is_too_much(); }
  bool is_too_much() const { return modes_.count() > kMostBodies; }

 private:
  void add_row(const HeldRows& rows, int row);
  void add_block(const HeldRows& rows, const HeldRows::Block& block);

  // The dense matrix of more bodies' motions costs too much.
  static constexpr int kMostBodies = 24;

  RigidModes modes_;
  Eigen::MatrixXd matrix_;
  DenseLdlt factor_;
  Eigen::VectorXd sums_;
  std::vector<int> touched_;  // bodies of a row
};

}  // namespace pliant
