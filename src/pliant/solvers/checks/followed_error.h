#pragma once

#include "pliant/core/state_archive.h"
#include "pliant/solvers/checks/rigid_turns.h"
#include "pliant/solvers/constrained/point_constraint_rows.h"
#include "pliant/solvers/linear/hessian_solver.h"

namespace pliant {

/// What particles are off, x* − x, followed from step to step by linear elasticity with inertia:
///   M ë + K e + Jᵀ λ = f,   f = (M/h² + K) d,
/// where d is the displacement that a step missed, K the elastic stiffness, and J what contact and
/// attachments hold. Implicit Euler with steps of any length. What came about longer than kHorizon
/// ago fades.
class FollowedError {
 public:
  static constexpr double kHorizon = 1.0;  ///< [s]

  /// Nothing is off.
  void begin() { off_.resize(3, 0); }

  /// Rigid bodies turned since the last time.
  void turn(const RigidTurns& turns);
  /// What steps missed and what resists it.
  struct Missed {
    const Forces& force;                  ///< f [N]
    const Eigen::VectorXd& inertia;       ///< m/h² [N/m]
    const PointConstraints& constraints;  ///< of which `rows` are
    const PointConstraintRows& rows;      ///< those of contact that carry force
    const Eigen::VectorXd& mobility;      ///< 0 of a pinned particle
    double dt;                            ///< h [s]
    /// Half of the steps are solved, and the others go once more as far: the midpoint rule, which
    /// damps nothing.
    bool are_doubled = false;
  };
  /// Goes on by `steps` of time steps, of which `missing` missed f each. `hessian` holds K, the
  /// inertia m/(steps h)², with half of the steps where they `are_doubled`, and as its rows those
  /// of contact before all others, and solves to the share `tolerance`. False where it cannot.
  bool follow(HessianSolver& hessian, const Missed& missed, double steps, double missing,
              double tolerance);

  /// The present state in two matrices of its size, to go on from it once more in another way.
  void keep(Positions& off, Eigen::Matrix3Xd& gained) const;
  void go_back_to(const Positions& off, const Eigen::Matrix3Xd& gained);

  const Positions& off() const { return off_; }        ///< [m]; without columns at the start
  const Positions& gained() const { return gained_; }  ///< of it in a time of h [m]
  int iterations() const { return iterations_; }       ///< of conjugate gradients, of the last one

  void save(StateArchive& numbers) const;
  void load(StateArchive& numbers);

 private:
  void fade(double seconds);
  void find_forces(const HessianSolver& hessian, const Missed& missed, double steps,
                   double missing);
  bool add_friction(const HeldRows& held, const Missed& missed);

  Positions off_, gained_;
  Eigen::Matrix3Xd move_, friction_;  // of off_ [m]; of contact that slides [N]
  double settled_ = 0.0;              // of what held rows are off
  int iterations_ = 0;
};

}  // namespace pliant
