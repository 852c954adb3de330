#pragma once

#include <vector>

#include "pliant/solvers/device/backend.h"
#include "pliant/solvers/iterations/factored_solver.h"

namespace pliant {

/// Quasi-Newton on the factor of projective dynamics (Liu, Bouaziz and Kavan 2017): L-BFGS whose
/// first inverse Hessian is A⁻¹, with a line search. The history is that of one time step.
class LbfgsSolver final : public FactoredSolver {
 public:
  LbfgsSolver(const StopRule& rule, int history);
  std::string_view name() const override { return "lbfgs"; }

 protected:
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  void solve_matrix(Eigen::Matrix3Xd& v) override { cholesky_.solve(v); }

 private:
  struct Pair {
    Positions s;     // change of positions [m]
    Forces y;        // change of the objective's gradient [N]
    double inverse;  // 1 / (s . y) [1/J]
  };
  void remember(const ProjectiveSystem& system);
  /// v <- H v by the two-loop recursion (Nocedal and Wright 2006, algorithm 7.4).
  void apply_inverse(Eigen::Matrix3Xd& v);

  CholeskySolver cholesky_;
  std::vector<Pair> pairs_;  // a ring, its oldest entry at next_ once it is full
  int held_ = 0;
  int next_ = 0;
  bool has_last_ = false;
  Positions last_x_;
  Forces last_forces_;
  std::vector<double> alphas_;
  Eigen::Matrix3Xd product_;
  int halved_steps_ = 0;
};

/// The same on a GPU, where a V-cycle of Multigrid on A stands for the factor.
DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history);
/// Or `sweeps` of a Chebyshev iteration on A.
DeviceSolverSpec lbfgs_device_spec(const StopRule& rule, int history, int sweeps);

SolverRegistry::Entry lbfgs_entry();

}  // namespace pliant
