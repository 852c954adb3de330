#pragma once

#include <limits>
#include <string>

#include "pliant/solvers/iterations/projective_solver.h"

namespace pliant {

/// Explicit position Verlet, x_{t+1} = 2 x_t - x_{t-1} + h² f/m (Yamada 2013, eq. 3.1), with the
/// difference x_t - x_{t-1} kept as h v. Stable below h = 2/omega_max: a longer
/// step is taken in substeps, at most `max_substeps`; it warns where these are too few.
class VerletSolver final : public ProjectiveSolver {
 public:
  explicit VerletSolver(int contact_sweeps, int max_substeps)
      : contact_sweeps_(contact_sweeps), max_substeps_(max_substeps) {}
  std::string_view name() const override { return "verlet"; }
  bool is_implicit() const override { return false; }
  int substeps_of_step(double dt) const override;

 protected:
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void add_predicted_forces(const ProjectiveSystem& system, Forces& forces) const override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  int contact_sweeps_, max_substeps_;
  Eigen::VectorXd mobility_;                                      // h² / m [m/N]
  double stable_step_ = std::numeric_limits<double>::infinity();  // surely [s]
  std::string warning_;
};

SolverRegistry::Entry verlet_entry();

}  // namespace pliant
