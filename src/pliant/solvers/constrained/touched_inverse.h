#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/solvers/constrained/equality_constrained_correction.h"
#include "pliant/solvers/linear/quasi_newton_pairs.h"
#include "pliant/solvers/linear/rigid_modes.h"

namespace pliant {

/// The inverse B of RigidModes with G = A⁻¹, or with what L-BFGS makes of A⁻¹, between the few
/// particles that constraints touch: conjugate gradients on contact forces need no more of it, and
/// never go through the factor of the whole body. A stays what it is from step to step, so that the
/// columns of its inverse are asked for once; pairs of L-BFGS and rigid motions add products of a
/// few vectors.
class TouchedInverse {
 public:
  /// A is another one, of `particles`; its factor has `nonzeros`. Forgets all.
  void prepare(Eigen::Index particles, Eigen::Index nonzeros, LinearOperator a_inverse);

  /// Asks for the columns of A⁻¹ of those particles, as far as they are not known.
  void ask(const std::vector<int>& particles);
  /// Entry of A⁻¹ of a particle on itself, that was asked for [m/N].
  double own(int particle) const { return own_[particle]; }

  /// For modes and pairs (null: there are none), which must outlive the correction.
  void begin_correction(const RigidModes& modes, QuasiNewtonPairs* pairs);
  /// From now on B between those particles, each once. False where the whole of it would be as
  /// quick, or where columns take too much memory.
  bool restrict_to(const std::vector<int>& particles);
  /// u = B f, a column of each particle, whose last number is 0 and stays so [N, m].
  void apply(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u);

 private:
  using Vector6 = RigidModes::Vector6;
  using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  const Eigen::VectorXd& column(int particle) const {
    return columns_[static_cast<std::size_t>(column_of_[static_cast<std::size_t>(particle)])];
  }
  bool knows_column(int particle) const {
    return column_of_[static_cast<std::size_t>(particle)] >= 0;
  }
  void forget_columns();
  void keep_column(int particle, Eigen::VectorXd values);
  /// What the restriction needs of the whole body, once for each correction.
  void meet_pairs();
  void meet_modes();
  void gather(const Eigen::Matrix3Xd& whole, Eigen::Matrix4Xd& part) const;
  /// A⁻¹ of the momentum of a motion y of a particle's component [m].
  Eigen::Vector3d answer_to_momentum(int particle, const Vector6& y) const;

  Eigen::Index nonzeros_ = 0;
  LinearOperator a_inverse_;
  Eigen::VectorXd own_;         // 0: not known [m/N]
  std::vector<int> column_of_;  // by particle; -1: not known
  std::vector<Eigen::VectorXd> columns_;
  Eigen::Matrix3Xd sides_;

  // Of the running correction.
  const RigidModes* modes_ = nullptr;
  QuasiNewtonPairs* pairs_ = nullptr;
  bool is_met_ = false;
  bool is_mass_met_ = false;              // to_mass_ is of this A
  Eigen::MatrixXd s_y_, z_y_;             // of pairs, newest first: s_j . y_k, z_j . y_k [J]
  std::vector<Matrix6X> s_p_, z_p_;       // of pairs: (M P)ᵀ s, (M P)ᵀ z of each component
  Eigen::Matrix3Xd to_mass_, to_arm_;     // A⁻¹ M/h² of 1 (first row), and of arms [m]
  std::vector<RigidModes::Matrix6> p_p_;  // (M P)ᵀ A⁻¹ M P of each component

  // Of the restriction.
  std::vector<int> particles_, unknown_;  // those whose columns had to be asked for
  std::vector<double> matrix_;  // A⁻¹ between them, row by row
  std::vector<Eigen::Matrix4Xd> s_, z_;
  std::vector<int> bodies_;  // components that they are of
  Matrix6X sums_, motions_;  // by component
  Eigen::VectorXd alphas_, of_y_, of_s_;
};

}  // namespace pliant
