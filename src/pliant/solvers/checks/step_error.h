#pragma once

#include "pliant/core/step/step_report.h"
#include "pliant/solvers/checks/coasting_pieces.h"
#include "pliant/solvers/checks/followed_error.h"
#include "pliant/solvers/checks/held_directions.h"
#include "pliant/solvers/checks/rigid_bend.h"
#include "pliant/solvers/checks/rigid_turns.h"
#include "pliant/solvers/components/pieces.h"
#include "pliant/solvers/constrained/constrained_correction.h"
#include "pliant/solvers/iterations/step_objective.h"
#include "pliant/solvers/linear/hessian_solver.h"

namespace pliant {

/// How far a body is from where it should be, as a share of how far it came: an estimate that needs
/// no other run, and works for any solver that approximates implicit Euler.
///
/// A step that is not solved to the end misses a displacement d, one correction of Newton's method
/// with contact and friction in it. FollowedError adds up what becomes of all of them: a motion
/// where nothing resists, a wrong equilibrium where something does. With e what particles are off,
/// the error is 2 |e| / |x + e − x(0)|, lengths the root mean squares over the masses of what
/// elements hold together; the distance from the start counts no less than a hundredth of a body's
/// size. Of several bodies in one system the worst counts. There is none where a liquid flows,
/// whose forces resist motions of what they hold as elements do.
class StepErrorEstimate {
 public:
  /// The system's structure or the time step changed.
  void prepare(const ProjectiveSystem& system);
  /// Whether it takes that system on: not one whose matrix would fill the memory, nor one of which
  /// more than half are loose particles, nor where a liquid flows.
  bool suits() const { return suits_; }
  /// Whether a whole step goes once more as far as the solver's, as those of the midpoint rule.
  void set_doubled(bool are_doubled) { are_doubled_ = are_doubled; }
  /// Nothing is off yet.
  void begin() {
    followed_.begin();
    coasting_.begin();
  }
  /// How many steps, of those that a solver takes, the error goes on by.
  struct Elapsed {
    double last = 1.0;     ///< the one that just ended
    double before = 0.0;   ///< those before it, since the last estimate
    double missing = 0.0;  ///< how many of these missed as much as the last one, the others nothing
  };
  /// The error after the step that just ended; negative where nothing is found.
  double estimate(ProjectiveSystem& system, double dt, const Elapsed& elapsed);
  /// The error after that step, were so many of those before it `missing` as much: begins again
  /// where estimate() began.
  double recount(const ProjectiveSystem& system, double dt, const Elapsed& elapsed);
  /// The error `steps` after the last one that was estimated, should none of these miss anything;
  /// of later and later steps. Bodies that nothing holds keep the velocity that they should not
  /// have, until they touch something.
  double later(ProjectiveSystem& system, double dt, double steps);
  /// What the error would be if each of the steps of the last `seconds`, of a second at the most,
  /// had missed as much as the one that was just estimated.
  double lasting(const ProjectiveSystem& system, double dt, double seconds);
  /// Of the last error that was asked for: the piece that is worst, whether nothing holds one,
  /// whether it is of clusters, and how far it came, or the least that counts [m]; 0 of what is
  /// none.
  int worst_piece() const { return worst_piece_; }
  bool is_free(int piece) const;
  bool has_clusters(int piece) const;
  double distance(int piece) const;
  /// What the last one cost, in iterations of a solver.
  double work() const;
  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  /// A component, or all particles that nothing ties to others.
  struct Piece {
    double mass = 0.0, error = 0.0, distance = 0.0, size = 0.0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    bool is_free = false, has_clusters = false;
  };
  /// Between two particles of a rigid body.
  struct Edge {
    int a, b;
    Eigen::Vector3d along;
  };
  void prepare(const ProjectiveSystem& system, double dt);
  void find_pieces(const ProjectiveSystem& system);
  void list_edges(const SharedEntries& rigid);
  /// Of all loose particles.
  int loose_piece() const { return static_cast<int>(pieces_.size()) - 1; }
  void predict(const ProjectiveSystem& system, double dt);
  bool find_correction(ProjectiveSystem& system);
  bool follow(const ProjectiveSystem& system, double dt, double steps, double missing,
              FollowedError& followed);
  bool follow(const ProjectiveSystem& system, double dt, const Elapsed& elapsed);
  void ask_constraints(ProjectiveSystem& system);
  void hold(const PointConstraintRows& rows);
  void count_work(int iterations);
  bool solve_with(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left);
  /// Whether something touches, and the directions in which that holds pieces.
  bool find_held(ProjectiveSystem& system);
  void begin_coasting(const ProjectiveSystem& system);
  /// Of what is off, and of how far pieces coasted since.
  double worst(const ProjectiveSystem& system, const FollowedError& followed, bool have_coasted);

  StepObjective objective_;
  HessianSolver hessian_;
  ConstrainedCorrection constrained_;
  ConstraintRows held_rows_;
  PointConstraintRows rows_;  // those of the last correction
  Eigen::VectorXd inertia_;   // M/T² [N/m]
  Eigen::VectorXd mobility_;  // kCompliance / D [m/N]
  Positions places_;          // the prediction, then the corrected ones [m]
  // Both hold, once a correction is found, the followed error before it, to begin there again: what
  // is off [m], and what of that came in a step [m]. Matrices of their own would take memory.
  Forces forces_;
  Eigen::Matrix3Xd correction_;
  Forces missed_;
  FollowedError followed_, lasting_;
  HeldDirections held_;  // in this step
  CoastingPieces coasting_;
  double coasted_ = 0.0;       // steps since the last estimate
  std::vector<int> piece_of_;  // of each particle; -1 of a pinned one
  std::vector<Piece> pieces_;
  std::vector<Edge> rigid_edges_;
  RigidBend rigid_bend_;
  RigidTurns rigid_turns_;
  int worst_piece_ = 0;
  StepReport unused_;
  bool is_stale_ = true, suits_ = false, are_doubled_ = false, has_clusters_ = false;
  double iteration_ = 0.0;   // of a solver's elements, in visits of entries
  int contacts_ = 0;         // active ones in the last estimate
  double iterations_ = 0.0;  // of conjugate gradients in the last estimate, with what rows cost
};

}  // namespace pliant
