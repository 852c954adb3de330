#pragma once

#include "pliant/core/step_report.h"
#include "pliant/solvers/components.h"
#include "pliant/solvers/constrained_correction.h"
#include "pliant/solvers/hessian_solver.h"
#include "pliant/solvers/step_objective.h"

namespace pliant {

/// How far a body is from where it should be, as a share of how far it came: an estimate that needs
/// no other run, and works for any solver that approximates implicit Euler.
///
/// A step that is not solved to the end misses a displacement d, one correction of Newton's method
/// with contact and friction in it. What it becomes when each of the steps since the start (those
/// of a second at the most) misses as much is
///   δ = (M/T² + K + Jᵀ S J)⁻¹ (M/h² + K) d,
/// T their time, K the elastic stiffness at x + d, J what contact holds: a motion where nothing
/// resists, a wrong equilibrium where something does. (At x, stretches that iterations left would
/// make sheets stiff against bending.) The error is 1.5 |δ| / |x + δ − x(0)|, lengths the root mean
/// squares over the masses of what elements hold together; the distance from the start counts no
/// less than a hundredth of a body's size. Of several bodies in one system the worst counts.
class StepErrorEstimate {
 public:
  /// What steps miss is followed for so long [s].
  static constexpr double kHorizon = 1.0;

  /// The system's structure or the time step changed.
  void prepare(const ProjectiveSystem& system);
  /// Whether it takes that system on: not one whose matrix would fill the memory, nor one of
  /// clusters, in which particles are tied to so many others that a matrix costs more than steps,
  /// nor loose particles, as those of liquids.
  bool suits() const { return suits_; }
  /// The error after the step that just ended at `time` [s]; negative where nothing is found.
  double estimate(ProjectiveSystem& system, double dt, double time);
  /// What the last one cost, in iterations of a solver.
  double work() const;

 private:
  /// A component, or all particles that nothing ties to others.
  struct Piece {
    double mass = 0.0, error = 0.0, distance = 0.0, size = 0.0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
  };
  void prepare(const ProjectiveSystem& system, double dt);
  void predict(const ProjectiveSystem& system, double dt);
  bool find_correction(ProjectiveSystem& system);
  /// Makes the correction of a step the error after so many of them.
  bool follow(const ProjectiveSystem& system, double steps);
  void ask_couplings(ProjectiveSystem& system);
  bool solve(Eigen::Matrix3Xd& v);
  bool solve_with(const ConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left);
  double worst(const ProjectiveSystem& system);

  StepObjective objective_;
  HessianSolver hessian_;
  ConstrainedCorrection constrained_;
  CouplingRows held_rows_;
  Eigen::VectorXd inertia_;   // M/T² [N/m]
  Eigen::VectorXd mobility_;  // kCompliance / D [m/N]
  Positions predicted_, corrected_;
  Forces forces_;
  Eigen::Matrix3Xd correction_, push_;
  std::vector<int> piece_of_;  // of each particle; -1 of a pinned one
  std::vector<Piece> pieces_;
  StepReport unused_;
  bool is_stale_ = true, suits_ = false;
  long entries_ = 0;         // of the elements' own matrices
  double iterations_ = 0.0;  // of conjugate gradients in the last estimate, with what rows cost
};

}  // namespace pliant
