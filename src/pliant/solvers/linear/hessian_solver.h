#pragma once

#include "pliant/core/system/system.h"
#include "pliant/solvers/checks/rigid_balance.h"
#include "pliant/solvers/components/pieces.h"
#include "pliant/solvers/linear/coarse_space.h"
#include "pliant/solvers/linear/pair_cholesky.h"

namespace pliant {

/// Solves with the stiffness K of elastic bodies, an inertia and directions that are held,
///   (M/T² + K + Jᵀ S J) d = b,
/// by conjugate gradients with two levels: blocks on the diagonal, and a coarse space of rigid
/// pieces. The number of iterations hardly grows with size, slenderness and stiffness of a body.
/// Where they take longer than a factor of the matrix would, as those of cloth do, that takes the
/// place of both levels, and stays for the step's other matrices for as long as it is near them.
/// However early they end, the displacement balances all net forces and torques on components that
/// nothing holds: a stiff body that is not solved for exactly still moves as a rigid one does.
class HessianSolver {
 public:
  /// The system's structure changed.
  void prepare() { is_prepared_ = false; }
  /// A step begins, which may factor its matrices or not: rough solutions need none. What it finds
  /// does not depend on the matrices of the one before. Where its coarse space `ties_rows`, rows
  /// that hold bodies on each other cost fewer iterations, and memory whenever they are others.
  /// Before that, nothing is factored or tied.
  void begin_step(bool may_factor, bool ties_rows);
  /// Takes K at the positions `x`, and `inertia` m/T² of each particle [N/m]. With kExact the
  /// matrix may turn out not to be positive definite.
  void assemble(const ProjectiveSystem& system, const Positions& x, const Eigen::VectorXd& inertia,
                Definiteness definiteness);
  /// J and S: use_rows() takes what they are then.
  HeldRows& rows() { return rows_; }
  const HeldRows& rows() const { return rows_; }
  void use_rows();

  /// `v` holds b [N], 0 for a pinned particle, and becomes d [m], until what iterations still add
  /// is that share of it in the matrix's norm, on each of the system's pieces; of a solve that
  /// `continues`, of the largest d since the last one that did not. False where the matrix is not
  /// positive definite.
  bool solve(double tolerance, Eigen::Matrix3Xd& v, bool continues = false);
  const Eigen::Matrix3Xd& residual() const { return residual_; }  ///< of the last solve [N]
  /// y = (M/T² + K) v.
  void multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const { matrix_.multiply(v, y); }
  /// Of each particle its answer to a force while all others stay, without rows [m/N].
  void find_own_answers(const Eigen::VectorXd& inertia,
                        std::vector<Eigen::Matrix3d>& answers) const;
  /// Blocks of the matrix, scalars counted as such, and as many as cost what particles share.
  double entries() const { return matrix_.entries(); }
  double shared() const { return matrix_.shared().work() / 9.0; }
  int iterations() const { return iterations_; }  ///< of the last solve

 private:
  /// Σ term(i) over all particles, in threads and always in the same order.
  template <class Term>
  double sum_columns(const Term& term);
  double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b);
  /// An approximate solution for the residual; returns their product [J].
  double precondition();
  /// Whether there are few particles, all of whose stiffness is in entries.
  bool can_factor() const;
  void factor_coarse();
  /// Iterations that cost as much as a factor of the present matrix.
  int price_of_factor();
  /// False where the matrix is not positive definite.
  bool factor_pairs();
  /// Puts the rigid motions into the solution that it lacks, and finds what of them is round-off.
  void balance(Eigen::Matrix3Xd& v);
  /// aᵀ b of each piece.
  void sum_pieces(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b, Eigen::VectorXd& sums);
  /// What a multiple `step` of the direction adds to dᵀ A d of each piece, of all `curvature`.
  void add_progress(double step, double curvature);
  /// Whether the last two iterations added less than that share of each piece's dᵀ A d.
  bool adds_little(double tolerance) const;

  Positions x_;  // of K
  Pieces pieces_;
  BlockMatrix matrix_;
  HeldRows rows_;
  CoarseSpace coarse_;
  RigidBalance balance_;
  PairCholesky pairs_;
  enum State { kNone, kOfOtherRows, kFresh };
  State coarse_state_ = kNone;
  State pairs_state_ = kNone;
  bool may_factor_ = false, ties_rows_ = false;  // in this step
  bool is_prepared_ = false;
  bool is_definite_ = true;                // by its construction
  std::vector<Eigen::Matrix3d> inverses_;  // of the blocks on the diagonal
  Eigen::Matrix3Xd residual_, preconditioned_, direction_, product_;
  // Of each piece, dᵀ A d [J]: of this solve, the largest before it, what the last two iterations
  // added, and what counts as none of it.
  Eigen::VectorXd squared_, largest_, added_, last_added_, none_;
  Eigen::VectorXd sums_;  // of sum_columns()
  int iterations_ = 0;
};

}  // namespace pliant
