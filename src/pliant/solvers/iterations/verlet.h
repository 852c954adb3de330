#pragma once

#include <string>

#include "pliant/solvers/iterations/projective_solver.h"

namespace pliant {

/// Explicit position Verlet, x_{t+1} = 2 x_t - x_{t-1} + h² f/m (Yamada 2013, eq. 3.1), with the
/// difference x_t - x_{t-1} kept as h v. Stable below h = 2/omega_max; it warns above.
class VerletSolver final : public ProjectiveSolver {
 public:
  explicit VerletSolver(int contact_sweeps) : contact_sweeps_(contact_sweeps) {}
  std::string_view name() const override { return "verlet"; }
  bool is_implicit() const override { return false; }

 protected:
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void add_predicted_forces(const ProjectiveSystem& system, Forces& forces) const override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  int contact_sweeps_;
  Eigen::VectorXd mobility_;  // h² / m [m/N]
  std::string warning_;
};

SolverRegistry::Entry verlet_entry();

}  // namespace pliant
