#pragma once

#include <functional>

#include "pliant/core/system/system.h"
#include "pliant/solvers/constrained/equality_constrained_correction.h"
#include "pliant/solvers/constrained/point_constraint_rows.h"
#include "pliant/solvers/constrained/touched_inverse.h"
#include "pliant/solvers/linear/motion_preconditioner.h"

namespace pliant {

/// A correction d of all particles together with the multipliers λ of the constraints:
///   P d = r + Jᵀ λ(d),  λ(d) = Π(λ0 − g(d)/C),
/// where P stands for the Hessian, g are the gaps and slips of points, C is a share of each point's
/// own answer to a force and Π the projection onto what a force may be (above the lowest; Coulomb's
/// disk). It is the minimum of a convex function, piecewise quadratic but for friction, whose bound
/// follows the normal force from round to round. Found by a semismooth Newton method with a line
/// search; each round solves its equations by conjugate gradients. λ becomes the next correction's
/// λ0 (proximal method of multipliers, Rockafellar 1976), so that gaps close whatever C is; with
/// it, constraints that contradict each other by a little, as those of many points on few
/// particles, have a solution too.
class ConstrainedCorrection {
 public:
  /// Whether the multipliers of all constraints of the system can be found, and there are any.
  static bool suits(const ProjectiveSystem& system);
  /// Whether some of them are found only by solvers that have them in their matrix.
  static bool needs_matrix(const ProjectiveSystem& system);

  void begin_step() { iterations_ = 0; }
  /// What a correction may leave out of balance, as a share of what it changed of the forces.
  void set_accuracy(double share) { settled_share_ = share; }
  /// C as a share of a point's own answer to a force.
  void set_compliance(double share) { compliance_share_ = share; }
  /// Whether the rounds of find(), and of the solve() with a factored matrix, are cautious:
  /// - the line search begins with the first round and counts what inexact solutions left;
  /// - from the fourth round on, the bound of friction makes half of its change;
  /// - a point that slides is held by the secant of its friction until a round finds the points
  ///   open, sticking and sliding as the one before. The tangent holds it across the slip alone, so
  ///   that a round moves it far too much, and the line search then stops all others too.
  /// Cautious rounds settle where sheets slide over solids, for which the others do not; those take
  /// fewer rounds to the last digits of friction.
  void set_cautious(bool is_cautious) { is_cautious_ = is_cautious; }
  /// C of a constraint whose point answers a force by `own` [m/N].
  double compliance(const PointConstraint& constraint, double own) const;
  /// Along its normal C is at least such a `share` of what the point's particles answer there by
  /// `answers`, while their neighbours stay [m/N]; null: as across. Across a sheet they answer a
  /// hundred times as much as along it, and a contact that is stiff beside that opens and closes
  /// its neighbours, round by round.
  void soften(const std::vector<Eigen::Matrix3d>* answers, double share) {
    soft_answers_ = answers;
    soft_share_ = share;
  }
  /// C of the contacts of rigid bodies is such a `share` of what it is otherwise. A body that
  /// opposite forces press moves less than its mass would let it: they are found the sooner the
  /// smaller C is.
  void stiffen_rigid(double share) { rigid_share_ = share; }
  /// Asks the constraints for their point constraints at the present positions.
  const PointConstraints& collect(ProjectiveSystem& system);
  /// Likewise those that tell theirs whoever finds the multipliers.
  void collect_told(ProjectiveSystem& system);
  /// Those that were collected last, with the multipliers that were found since.
  PointConstraints& constraints() { return constraints_; }
  /// Their gaps and slips after displacements `d`, as if these were small.
  void follow(const Positions& d);
  /// Hands the multipliers to the constraints that told their point constraints.
  void give_multipliers(ProjectiveSystem& system);
  /// By how much the constraints' multipliers miss Π(λ − g/C) at the present positions, squared and
  /// in the norm of a residual, Σ |Δλ|² w with w each particle's part of a point's `mobility` [J].
  void find_squared_violations(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
                               Eigen::VectorXd& violations);
  /// An approximate inverse of P, of all particles; and, where `touched` is not null, the same
  /// between the few that constraints touch.
  struct Inverse {
    const LinearOperator& whole;
    TouchedInverse* touched = nullptr;
  };
  /// Under the constraints that were collected last. `d` holds r [N], 0 for a pinned particle, and
  /// becomes d [m]. `mobility` [m/N], a particle's answer to a force while its neighbours stay, is
  /// the scale of C; `own_answers` [m/N] are those while they move along, but for rigid motions;
  /// `modes` are those of the present positions.
  void solve(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
             const Eigen::VectorXd& own_answers, const RigidModes& modes, const Inverse& p_inverse,
             Eigen::Matrix3Xd& d);

  /// The share of displacements `d` for which all constraints are what they were at the start.
  double reached_share(const Positions& d) const;
  /// P d − r of the last solve: the forces of the constraints' multipliers [N].
  const Forces& forces() const { return forces_; }
  int iterations() const { return iterations_; }  ///< of conjugate gradients since begin_step()

  /// v <- (P + Jᵀ C⁻¹ J)⁻¹ (v − left) for some rows J, C, where `left` [N] is what an inverse that
  /// is not exact left. False where that matrix is not positive definite.
  using MatrixWithRows =
      std::function<bool(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left)>;
  /// The same for a solver that factors its matrix with the rows in it. False: it could not.
  bool solve(ProjectiveSystem& system, const Eigen::VectorXd& mobility,
             const MatrixWithRows& inverse, Eigen::Matrix3Xd& d);
  /// The last correction is not made: constraints get the multipliers back that it began with.
  void take_back(ProjectiveSystem& system);
  /// The same in `rounds` at the most and without a word to the constraints. Called again, it goes
  /// on from the multipliers that it found, whatever those of the constraints are. `d` may have
  /// more columns than there are vertices: of other coordinates that `inverse` knows.
  bool find(int rounds, const Eigen::VectorXd& mobility, const MatrixWithRows& inverse,
            Eigen::Matrix3Xd& d);
  /// Whether the last find() ended with forces that fulfil all constraints.
  bool is_found() const { return is_found_; }
  /// Whether its displacement is in balance with the forces, but for what inexact solutions left.
  bool is_balanced() const { return is_balanced_; }

 private:
  struct Force {
    double normal = 0.0;
    Eigen::Vector3d friction = Eigen::Vector3d::Zero();
  };
  enum class Hold { kUnknown, kOpen, kSticks, kSlides };
  struct State {
    double own = 0.0;            // answer of the point to a force while all else stays [m/N]
    double compliance = 0.0;     // C [m/N]; 0: nothing can move it
    double along_normal = 0.0;   // C there [m/N]
    double bound = 0.0;          // of the friction of this round [N]
    Hold hold = Hold::kUnknown;  // in the last round
    double uncut = 0.0;          // friction force of the answer before it was cut to that [N]
    Eigen::Vector3d moved;       // displacement of the point by d [m]
    Eigen::Vector3d moves;       // and by the round's [m]
    Force kept;                  // λ0
    Force used;                  // with which d is in balance
    Force answer;                // λ(d)
    Force next;                  // with which d and the round's displacement are
  };

  /// The same of a constraint that ties many particles.
  struct Tie {
    double own = 0.0, compliance = 0.0;
    double scale = 0.0;     // length of the gradients together
    bool is_bound = false;  // the answer is the lowest or the highest force
    double kept = 0.0, used = 0.0, answer = 0.0, next = 0.0;
  };

  void begin(const Eigen::VectorXd& mobility);
  /// What the point answers along its normal, as far as it is softened [m/N].
  double soft_answer(const PointConstraint& constraint, const Eigen::VectorXd& mobility) const;
  void begin_ties(const Eigen::VectorXd& mobility);
  double displacement(const TyingConstraint& constraint, const Positions& d) const;
  void answer_ties(const Positions& d, double share);
  void add_tie_forces(double Tie::*which, double sign, Forces& f) const;
  void add_tie_violations(const Eigen::VectorXd& mobility, Eigen::VectorXd& violations) const;
  void find_tie_forces();
  Eigen::Vector3d displacement(const PointConstraint& constraint, const Positions& d) const;
  /// λ at displacements d + share move, with the bounds of this round; with a share of 0 before any
  /// other of the same d.
  void answer(const Positions& d, double share);
  /// Keeps whether each point is open, sticks or slides. Returns whether all do as in the last
  /// round.
  bool are_held_alike();
  /// The rows of those that answer, and λ of the others as `next`.
  void list_rows();
  void list_rows(int number, bool by_tangents);
  void solve_rows(const Eigen::VectorXd& mobility, const Inverse& p_inverse);
  /// Conjugate gradients on the rows; and, unless between points, the displacement of what they
  /// find.
  void iterate_rows(const Eigen::VectorXd& mobility, const Inverse& p_inverse, double goal);
  /// product_ = J P⁻¹ Jᵀ direction_.
  void multiply_rows(const Eigen::VectorXd& mobility, const Inverse& p_inverse);
  /// Whether the rounds of a correction know displacements of points alone, and those of all other
  /// particles follow at its end.
  bool begin_between_points(const Eigen::VectorXd& mobility, const Inverse& p_inverse);
  void end_between_points(const LinearOperator& p_inverse, Positions& d);
  /// The particles of all constraints that nothing holds, in order, and their places among these.
  void list_points(const Eigen::VectorXd& mobility);
  /// Those of the round's rows.
  void select_points();
  /// A round between points, of moved_ [N]: the residual of its rows, and the displacement of all
  /// points by what they found.
  void begin_selected(TouchedInverse& inverse);
  void end_selected(TouchedInverse& inverse);
  double search(const Positions& d);
  void add_forces(Force State::*which, double sign, Forces& f) const;
  /// Σ of a round's displacements times forces.
  double work(Force State::*which) const;
  double work(double Tie::*which) const;
  bool is_settled(bool first) const;
  bool solve_matrix(const Eigen::VectorXd& mobility, const MatrixWithRows& inverse);
  /// Takes the rows' multipliers into `next`.
  void take_rows();
  /// What friction may hold in the coming round.
  void set_bounds(int round);
  /// Moves d, and the forces that are used, by the round's displacement as far as search() says,
  /// and returns that.
  double move(Positions& d, bool searches);
  void keep_multipliers(const Eigen::VectorXd& mobility, Eigen::Index size);
  void tell_constraints(ProjectiveSystem& system);

  PointConstraints constraints_;
  std::vector<State> states_;
  std::vector<Tie> ties_;
  PointConstraintRows rows_;
  MotionPreconditioner preconditioner_;
  Eigen::VectorXd multipliers_, residual_, preconditioned_, direction_, product_;
  Forces forces_;
  Forces unbalanced_;  // r + Jᵀ λ − P d [N]
  Forces left_;        // of it by a round's displacement
  // Whether a round took its whole step: what is unbalanced is then what inexact solutions left.
  bool is_balanced_ = false;
  Positions move_;  // of a round [m]
  Eigen::Matrix3Xd moved_;
  bool is_between_points_ = false;
  std::vector<int> points_, column_of_;  // by particle, its place in points_ or -1
  Positions start_;                      // d before the first round [m]
  Eigen::Matrix4Xd pushed_, gone_;       // of points_: of a round [N, m]
  Eigen::Matrix4Xd all_pushed_;          // likewise, of all rounds
  // Places in points_ of those of the round's rows, and by particle, the place among these or -1.
  std::vector<int> selected_, selected_column_of_;
  Eigen::Matrix4Xd pushes_, answers_;  // of these: of a direction [N, m]
  double goal_ = 0.0;                  // of the equations' residual [m]
  int iterations_ = 0;
  bool is_found_ = false;
  bool is_cautious_ = false;
  const std::vector<Eigen::Matrix3d>* soft_answers_ = nullptr;
  double soft_share_ = 0.0;
  double rigid_share_ = 1.0;
  double settled_share_ = 1e-2;
  double compliance_share_ = 0.25;
};

}  // namespace pliant
