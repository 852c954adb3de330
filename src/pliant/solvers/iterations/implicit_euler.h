#pragma once

#include "pliant/solvers/iterations/projective_solver.h"
#include "pliant/solvers/iterations/step_objective.h"
#include "pliant/solvers/iterations/stop_check.h"
#include "pliant/solvers/linear/projective_product.h"

namespace pliant {

/// Implicit Euler by minimising the step's objective. A solver of this family only says how one
/// iteration corrects the positions for the unbalanced forces; at convergence all of them give the
/// same answer.
class ImplicitEulerSolver : public ProjectiveSolver {
 protected:
  explicit ImplicitEulerSolver(const StopRule& rule,
                               ErrorControl::By by = ErrorControl::By::kIterations)
      : ProjectiveSolver(rule, by) {}

  void prepare_system(const ProjectiveSystem& system, double dt) final;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) final;

  /// Whether it asks for matrix().
  virtual bool needs_matrix() const { return false; }
  /// product() has just been assembled.
  virtual void prepare_iterations(const ProjectiveSystem& system) = 0;
  virtual void begin_iterations(ProjectiveSystem& /*system*/, StepReport& /*report*/) {}
  /// Corrects `system.particles.x`; forces() are the unbalanced ones there, without those of the
  /// constraints. Returns false when round-off stops all further progress.
  virtual bool iterate(ProjectiveSystem& system, StepReport& report) = 0;
  /// Iterations that had come to their end go on, with contacts that they did not know of.
  virtual void go_on() {}
  /// Whether the step is done where, after the first iteration, forces balance but for round-off
  /// and iterations no longer better that.
  virtual bool ends_at_round_off() const { return false; }
  /// What the point constraints miss of each particle at the present positions, squared, in the
  /// norm of a residual [J]; empty: nothing.
  virtual void find_squared_violations(ProjectiveSystem& /*system*/,
                                       Eigen::VectorXd& /*violations*/) {}
  /// After the last iteration of those that did not converge, before what they left is measured.
  virtual void judge_last_iteration(ProjectiveSystem& /*system*/, StepReport& /*report*/) {}
  /// Moves `system.particles.x` to the best of what iterations saw.
  virtual void choose_end(ProjectiveSystem& /*system*/, StepReport& /*report*/) {}
  /// Whether take_again() can better a step that gained energy.
  virtual bool may_take_again(const ProjectiveSystem& /*system*/,
                              const StepReport& /*report*/) const {
    return false;
  }
  /// Its iterations anew.
  virtual void take_again(ProjectiveSystem& /*system*/, StepReport& /*report*/) {}
  virtual void end_iterations(ProjectiveSystem& /*system*/, StepReport& /*report*/) {}
  /// Whether begin_iterations() relaxes the constraints.
  virtual bool asks_constraints_first() const { return false; }
  /// Whether its iterations have nothing that answers contacts by the inertia of whole bodies.
  virtual bool begins_rigidly(const ProjectiveSystem& /*system*/) const { return true; }
  /// Of the constraints' final projections [m/N].
  virtual const Eigen::VectorXd& mobility() const = 0;

  /// A = M/h² + sum w S^T S, its products, and its entries where needs_matrix().
  const ProjectiveProduct& product() const { return product_; }
  const SparseRows& matrix() const { return product_.shares() ? matrix_ : product_.entries(); }
  const StepObjective& objective() const { return objective_; }
  const Forces& forces() const { return forces_; }  ///< r [N]

  void compute_forces(const ProjectiveSystem& system, StepReport& report) {
    objective_.forces(system, forces_, report);
  }
  /// Of forces(), with those of the constraints.
  double relative_residual(ProjectiveSystem& system, StepReport& report);
  /// x += mobility r, then the constraints from scratch.
  void jacobi_update(ProjectiveSystem& system, const Eigen::VectorXd& mobility, StepReport& report);

 private:
  friend class LockstepSolver;  // takes the iterations of others in turn

  void iterate_to_end(ProjectiveSystem& system, StopCheck& stop, StepReport& report);

  ProjectiveProduct product_;
  SparseRows matrix_;  // where product_ does not have its entries
  StepObjective objective_;
  Forces forces_;
  Eigen::VectorXd violations_;
};

}  // namespace pliant
