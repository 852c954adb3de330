#pragma once

#include "pliant/solvers/iterations/factored_solver.h"
#include "pliant/solvers/linear/hessian_solver.h"

namespace pliant {

/// Newton's method with line search. Its linear equations are solved by conjugate gradients with
/// two levels, contact and friction in them. A Hessian is kept for as long as corrections shrink
/// fast with it. It is the one with every element's part made positive semi-definite (Teran et al.
/// 2005), which is right far from the solution too; where corrections shrink slowly although it is
/// fresh, the exact one is tried, which may turn out not to be positive definite.
class NewtonSolver final : public FactoredSolver {
 public:
  /// `linear_tolerance`: share of each correction that is left out of it.
  explicit NewtonSolver(const StopRule& rule, double linear_tolerance = 1e-12)
      : FactoredSolver(rule, ErrorControl::By::kTolerance), linear_tolerance_(linear_tolerance) {}
  std::string_view name() const override { return "newton"; }
  // Its line search goes less far than forces take it where it does not converge as it should.
  bool loses_momentum(const ProjectiveSystem& /*system*/) const override { return is_unsolved_; }
  // Iterations that end at a tolerance leave as much of it.
  // Rounds of contact that never took a whole step leave a little. What is more is of forces that
  // have not converged, and would move what is gripped.
  bool leaves_momentum() const override { return true; }
  double most_momentum_left() const override { return is_unsolved_ ? 1.0 : 1e-6; }

 protected:
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void go_on() override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool has_constraints_in_matrix() const override { return true; }
  // It finds a matrix and solves with it, as an estimate does.
  double iteration_price() const override { return 60.0; }
  double residual_share(const ProjectiveSystem& system) const override;
  /// More exactly and until they converge.
  void take_again(ProjectiveSystem& system, StepReport& report) override;
  /// Without constraints a step that converged gains nothing.
  bool may_take_again(const ProjectiveSystem& system, const StepReport& report) const override {
    return finds_multipliers(system) ||
           (system.constraints.empty() && report.ended_by != EndedBy::kTolerance);
  }

 private:
  /// Makes correction() that of the unbalanced forces, under what constraints hold.
  bool correct_under_constraints(ProjectiveSystem& system);
  bool correct_under_rows(ProjectiveSystem& system);
  /// `solve` with the present Hessian, or, where that is not positive definite, another.
  template <class Solve>
  bool solve_definite(const ProjectiveSystem& system, const Solve& solve);
  void assemble(const ProjectiveSystem& system);
  bool solve_with(const PointConstraintRows& rows, Eigen::Matrix3Xd& v, Forces& left);
  bool solve(Eigen::Matrix3Xd& v);
  /// dᵀ(r + Jᵀλ), twice of what the correction d promises to lower the objective by [J].
  double promise() const;
  /// Whether constraints press a point from opposite sides.
  bool is_contradicted();
  /// Lessens the compliance where corrections shrink slowly.
  void follow_slow(double decrement, double step);
  /// Softens contacts whose rounds do not come into balance, and less so where corrections shrink
  /// slowly: forces then follow gaps slowly.
  void follow_softened(double decrement, double step);
  /// Chooses the next Hessian after a correction of that `decrement`, of which `step` was taken.
  void judge(double decrement, double step);
  void exact_failed();
  /// Takes back the forces of a correction of which no share lowers the objective: with them the
  /// next one would be worse.
  void reject(ProjectiveSystem& system);
  /// Says that an iteration cannot be made; false.
  static bool give_up(StepReport& report);
  /// Whether corrections are so exact that the exact Hessian makes them converge quadratically.
  bool is_tight() const { return linear_tolerance_ < 1e-4; }

  double linear_tolerance_;
  HessianSolver hessian_;
  Eigen::VectorXd mobility_of_constraints_;   // C that constraints have in the Hessian [m/N]
  Eigen::VectorXd compliance_;                // a share of that, in the running step [m/N]
  Eigen::VectorXd missed_;                    // of rows [m]
  std::vector<Eigen::Matrix3d> own_answers_;  // of particles, by the Hessian [m/N]
  Positions part_;                            // of a correction [m]
  Positions start_, first_;                   // of an iteration, of the step's first [m]
  Definiteness definiteness_ = Definiteness::kProjected;
  bool is_under_constraints_ = false;  // the present correction
  bool is_stuck_ = false;              // corrections are round-off
  bool is_unsolved_ = false;           // the step's iterations missed the asked tolerance
  bool is_cut_ = false;                // it went as far as its constraints say anything
  bool is_taken_again_ = false;        // the step's iterations
  bool continues_ = false;             // the present correction has solved before
  bool is_kept_ = false;               // the Hessian is not taken anew
  int age_ = 0;                        // corrections with it
  double last_decrement_ = 0.0;        // 0: there was none
  double first_decrement_ = 0.0;       // of the step
  int exact_wait_ = 0;                 // iterations before an exact one is tried again
  int exact_failures_ = 0;             // of the step
  int rejected_ = 0;                   // corrections, since one was made, as far as that counts
  int slow_ = 0;                       // likewise that shrank slowly, one after another
  int slow_soft_ = 0;                  // likewise, of softened contacts
  double softness_ = 0.0;              // of contacts along their normals: share of own_answers_
  int stiffened_ = 0;                  // times that the compliance became less in the step
  int hessians_ = 0, projected_ = 0, gradients_ = 0;
};

SolverRegistry::Entry newton_entry();

}  // namespace pliant
