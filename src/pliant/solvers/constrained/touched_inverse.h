#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/solvers/components/rigid_modes.h"
#include "pliant/solvers/constrained/equality_constrained_correction.h"
#include "pliant/solvers/linear/quasi_newton_pairs.h"

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

  /// The entries of A⁻¹ of those particles on themselves, in their order [m/N].
  const std::vector<double>& own(const std::vector<int>& particles);

  /// Begins a correction with these modes and pairs (null: there are none), which must outlive it.
  void begin_correction(const RigidModes& modes, QuasiNewtonPairs* pairs);
  /// Makes apply() that of those particles, each named once, of which about so many will be
  /// selected. Returns false, and nothing is made, where the whole of B is as quick, or where
  /// columns would take too much memory.
  bool restrict_to(const std::vector<int>& particles, std::size_t selected);
  /// u = B f [N, m]. Each has a column for each particle; the fourth number of a column is 0 and
  /// stays so.
  void apply(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) { apply(all_, f, u); }
  /// Makes apply_selected() that of some of those particles, named by their places among these.
  void select(const std::vector<int>& places);
  /// The same with a column for each of these.
  void apply_selected(const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u) { apply(selected_, f, u); }

 private:
  using Vector6 = RigidModes::Vector6;
  using Matrix6X = Eigen::Matrix<double, 6, Eigen::Dynamic>;

  const Eigen::VectorXd& column(int particle) const {
    return columns_[static_cast<std::size_t>(column_of_[static_cast<std::size_t>(particle)])];
  }
  bool knows_column(int particle) const {
    return column_of_[static_cast<std::size_t>(particle)] >= 0;
  }
  /// B between some particles.
  struct Part {
    std::vector<int> particles;
    std::vector<double> matrix;          // A⁻¹ between them, row by row
    std::vector<Eigen::Matrix4Xd> s, z;  // of pairs, newest first
    std::vector<int> bodies;             // their components, each once
  };
  /// Calls visit(particle, c) when row c of sides_ is the column of A⁻¹ of each of `particles`.
  template <class Visit>
  void solve_columns(const std::vector<int>& particles, const Visit& visit);
  /// Keeps the columns of those particles, if need be instead of all others.
  void keep_columns(const std::vector<int>& particles);
  /// What the restriction needs of the whole body, once for each correction.
  void meet_pairs();
  void meet_modes();
  void fill_matrix(Part& part) const;
  void fill_pairs(Part& part) const;
  void find_bodies(Part& part) const;
  void apply(const Part& part, const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u);
  /// Calls visit(particle, column, component) for those of a part that a free component holds.
  template <class Visit>
  void for_members(const Part& part, const Visit& visit) const;
  /// The three parts of apply() beside A⁻¹ itself. RigidModes::take_out(): finds the motions y
  /// whose momentum M P y the forces have.
  void take_out_motions(const Part& part, const Eigen::Matrix4Xd& f);
  double along_motions(const Part& part, const Matrix6X& momenta) const;
  /// The two loops of L-BFGS.
  void add_pairs(const Part& part, const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u);
  /// RigidModes::put_in(): puts y in the place of the rigid part of u.
  void put_in_motions(const Part& part, const Eigen::Matrix4Xd& f, Eigen::Matrix4Xd& u);
  /// A⁻¹ of the momentum of a motion y of a particle's component [m].
  Eigen::Vector3d answer_to_momentum(int particle, const Vector6& y) const;

  LinearOperator a_inverse_;
  std::size_t most_touched_ = 0;   // particles between which the restriction may be
  std::size_t most_selected_ = 0;  // of them, between which it is quicker
  std::vector<int> column_of_;     // by particle, its place in columns_; -1: it is not kept
  std::vector<Eigen::VectorXd> columns_;
  std::vector<int> unknown_;
  std::vector<double> own_;
  Eigen::Matrix3Xd sides_;

  // These belong to the running correction.
  const RigidModes* modes_ = nullptr;
  QuasiNewtonPairs* pairs_ = nullptr;
  bool is_met_ = false;
  bool is_mass_met_ = false;              // whether to_mass_ belongs to the present A
  Eigen::MatrixXd s_y_, z_y_;             // of pairs, newest first: s_j . y_k, z_j . y_k [J]
  std::vector<Matrix6X> s_p_, z_p_;       // of pairs: (M P)ᵀ s, (M P)ᵀ z of each component
  Eigen::Matrix3Xd to_mass_, to_arm_;     // A⁻¹ M/h² of 1 (first row), and of arms [m]
  std::vector<RigidModes::Matrix6> p_p_;  // (M P)ᵀ A⁻¹ M P of each component

  Part all_, selected_;
  Matrix6X sums_, motions_;  // by component
  Eigen::VectorXd alphas_, of_y_, of_s_;
};

}  // namespace pliant
