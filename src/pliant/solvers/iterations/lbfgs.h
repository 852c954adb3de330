#pragma once

#include "pliant/solvers/device/backend.h"
#include "pliant/solvers/iterations/factored_solver.h"
#include "pliant/solvers/linear/quasi_newton_pairs.h"

namespace pliant {

/// Quasi-Newton on the factor of projective dynamics (Liu, Bouaziz and Kavan 2017): L-BFGS whose
/// first inverse Hessian is A⁻¹, with a line search. The history is that of one time step.
class LbfgsSolver final : public FactoredSolver {
 public:
  LbfgsSolver(const StopRule& rule, int history);
  std::string_view name() const override { return "lbfgs"; }

 protected:
  bool needs_matrix() const override { return true; }
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  void solve_matrix(Eigen::Matrix3Xd& v) override { cholesky_.solve(v); }
  QuasiNewtonPairs* pairs() override { return &pairs_; }

 private:
  void remember(const ProjectiveSystem& system);
  /// From the best iterate, without a history. False: that was tried in this step.
  bool begin_anew();

  CholeskySolver cholesky_;
  QuasiNewtonPairs pairs_;
  bool has_last_ = false;
  bool is_plain_ = false;  // it remembers nothing more in this step
  Positions last_x_;
  Forces last_forces_;
  Eigen::Matrix3Xd product_;
  int halved_steps_ = 0;
};

/// The same on a GPU, where a V-cycle of Multigrid on A stands for the factor.
DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history);
/// Or `sweeps` of a Chebyshev iteration on A.
DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history, int sweeps);

SolverRegistry::Entry lbfgs_entry();

}  // namespace pliant
