#pragma once

#include "pliant/solvers/iterations/factored_solver.h"

namespace pliant {

/// Projective dynamics as published (Bouaziz et al. 2014): the constant matrix is factored once,
/// each iteration is one local step and one solve, x += d, d = A⁻¹ r. Factored anew only when
/// masses, fixed particles, elements or the time step change.
///
/// Where A is far above the Hessian, as in slivers, iterations crawl: each makes nearly the last
/// one's correction again, and what they leave, when they end early, is energy from nowhere. Where
/// d hardly shrinks it is extrapolated from the last two (Anderson acceleration of window 1; Peng
/// et al. 2018, "Anderson acceleration for geometry optimization and physics simulation"), in the
/// norm of A and as far as the objective falls. Not where constraints hold something, which changes
/// what is solved.
class DirectSolver final : public FactoredSolver {
 public:
  explicit DirectSolver(const StopRule& rule) : FactoredSolver(rule) {}
  std::string_view name() const override { return "direct"; }

 protected:
  bool needs_matrix() const override { return true; }
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  void solve_matrix(Eigen::Matrix3Xd& v) override { cholesky_.solve(v); }

 private:
  void move(ProjectiveSystem& system, StepReport& report);
  /// x -> x + d - γ (x + d - x' - d'), γ such that |d| would become least were all linear. False,
  /// with x anywhere, where that does not lower the objective.
  bool extrapolate(ProjectiveSystem& system);

  CholeskySolver cholesky_;
  Eigen::Matrix3Xd product_;
  Positions start_;
  Positions last_x_, last_correction_;  // x', d' [m]
  Forces last_balance_;                 // r' [N]
  double last_size_ = 0.0;              // |d'|² of A [J]; 0: there is none
  int extrapolated_ = 0;                // iterations of the step
};

SolverRegistry::Entry direct_entry();

}  // namespace pliant
