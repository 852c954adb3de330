#pragma once

#include <vector>

#include "pliant/solvers/checks/rigid_balance.h"
#include "pliant/solvers/constrained/condensed_contacts.h"
#include "pliant/solvers/constrained/constrained_correction.h"
#include "pliant/solvers/iterations/step_objective.h"

namespace pliant {

/// The momentum that iterations lose which stop early. Forces between elements change neither the
/// momentum nor the angular momentum of a connected component that nothing holds from outside, so
/// that at the end of every step of implicit Euler
///   Σ m (x − y)/h² = Σ f,  Σ q × m (x − y)/h² = Σ q × f,
/// f the forces of the constraints, y the prediction and q seen from the component's centre.
/// Displacements by a share of a vertex's own answer to a force leave that open, and what contacts
/// answer to them is too much by the stiffness over the inertia. Here components move as rigid
/// bodies and contacts answer that with Coulomb's law, until both hold: all contacts are condensed
/// onto the six rigid motions of each component.
class MomentumBalance {
 public:
  void prepare(const ProjectiveSystem& system, double dt);
  /// Whether there are such components.
  bool is_used() const { return modes().count() > 0; }
  /// Before a step's iterations: moves `system.particles.x` to where rigid components would end,
  /// where that is a better start than to let the vertices in contact alone give way: where φ of
  /// `objective` and the work of friction are less. `mobility` [m/N] is a vertex's own answer to a
  /// force.
  void begin(ProjectiveSystem& system, const StepObjective& objective,
             const Eigen::VectorXd& mobility, double dt);
  /// After them: moves `system.particles.x` and sets the multipliers of the contacts. Nothing
  /// changes where iterations converged.
  void restore(ProjectiveSystem& system, const Eigen::VectorXd& mobility, double dt);

  /// After them, instead of restore(), where the positions `ends` that they found cannot be: moves
  /// free components as rigid bodies, each in the shape of the step's beginning with that share of
  /// its change, and sets the multipliers of the contacts. All other vertices are where `ends` has
  /// them.
  void move_rigidly(ProjectiveSystem& system, const Positions& ends, double share,
                    const Eigen::VectorXd& mobility, double dt);
  /// Whether that can be: there are free components, all constraints are told, and no body of
  /// coordinates is among them.
  bool can_move_rigidly(const ProjectiveSystem& system) const;

  /// What momentum and angular momentum the present positions lack of those that the forces give
  /// that are told.
  void compare(const ProjectiveSystem& system, double dt);
  /// At the step's end: whether what compare() found is more than that share of the motion and what
  /// external forces change of it. More than all of that is what forces tell that press a stiff
  /// body from two sides and did not converge.
  bool is_missed_by(double share, const ProjectiveSystem& system, double dt) const;
  /// At the step's end: gives velocities what compare() found. False: they have it.
  bool correct_velocities(ProjectiveSystem& system);
  /// But not in this step, which ends where no forces would have taken it.
  void lose() { is_missed_ = false; }
  /// But not the momentum, nor the angular momentum, of which more is missed than that share of the
  /// motion as is_missed_by() sees it: loose equations leave little of one and much of the other.
  void lose_above(double share, const ProjectiveSystem& system, double dt);

 private:
  /// Vertices of constraints are numbered anew, so that no round looks at all vertices.
  void number_vertices(const Eigen::VectorXd& mobility);
  /// Forces and torques on components without those of constraints, as the first columns of `d`.
  void find_unbalanced(const ProjectiveSystem& system, double dt, Eigen::Matrix3Xd& d);
  /// turning_, for velocities after a step of `dt` [s].
  void find_turning(const Particles& particles, double dt);
  /// motions_, and the multipliers that answer them.
  void find_motions(const ProjectiveSystem& system, double dt);
  /// With all contacts in one matrix. False: that did not converge.
  bool find_motions_together();
  /// The same from the same beginning, contact after contact: where that did not converge, or there
  /// are more components than it is made for.
  void find_motions_in_turns();
  void set_moved(const Eigen::VectorXd& motions);
  /// Likewise over and over, while components move so, until motions are small beside the first;
  /// `begin_pass`(k) comes before the k-th of at most `passes`.
  template <class BeginPass>
  void find_balance(ProjectiveSystem& system, double dt, int passes, const BeginPass& begin_pass);
  /// Contacts of free components carry nothing any more; those of others what they carry.
  void forget_multipliers();
  bool solve(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left);
  /// Moves vertices of constraints, each alone, out of what they are in.
  void close_gaps(Positions& x);
  /// Of slips under the present normal forces [J].
  double friction_work();

  /// Of missed_ and of the motion, in the metric of m/h², as modes are.
  double missed_norm(bool shifts, bool turns) const;
  double motion(const ProjectiveSystem& system, double dt) const;

  const RigidModes& modes() const { return rigid_.modes(); }
  // Columns of components come first, then those of vertices_, and room for more of these.
  static Eigen::Index body_column(int body) { return 2 * body; }
  Eigen::Index vertex_column(Eigen::Index k) const { return 2 * modes().count() + k; }
  int vertex_of(int column) const {
    return vertices_[static_cast<std::size_t>(column - 2 * modes().count())];
  }

  RigidBalance rigid_;
  ConstrainedCorrection contacts_;
  CondensedContacts turns_;
  std::vector<PointConstraint> begun_;  // before find_motions()
  Eigen::VectorXd sums_;                // of forces and torques on components, likewise
  HeldRows springs_;
  std::vector<int> vertices_;  // of constraints
  std::vector<int> numbers_;   // of all vertices in vertices_; -1: it is not in it
  Eigen::VectorXd mobility_;   // of vertices_ [m/N]
  // Forces [N] and displacements [m]: of each component a force and a torque [N m], or how it is
  // shifted and turned [rad], then of vertices_.
  Eigen::Matrix3Xd moved_;
  Eigen::Matrix3Xd closed_;               // displacements of vertices_ alone [m]
  Eigen::Index room_ = 0;                 // for vertices_
  bool is_missed_ = false;                // momentum
  Eigen::VectorXd missed_;                // motions of velocities [m/s, rad/s]
  std::vector<Eigen::Vector3d> turning_;  // of each component, over h², that is missed; or none
  Eigen::VectorXd motions_;               // six numbers of each component [m, rad]
  Eigen::Matrix3Xd work_;                 // of all vertices
};

}  // namespace pliant
