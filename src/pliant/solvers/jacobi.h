#pragma once

#include "pliant/solvers/projective_solver.h"

namespace pliant {

/// Projective dynamics (Bouaziz et al. 2014) solved by Jacobi iterations: every particle moves by
/// all forces on it over the diagonal D = m/h² + absolute row sums of sum w S^T S. With that
/// diagonal no iteration raises the step's objective, whatever the mesh.
class JacobiSolver final : public ProjectiveSolver {
 public:
  explicit JacobiSolver(const StopRule& stop) : stop_(stop) {}
  std::string_view name() const override { return "jacobi"; }

 protected:
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  /// One update from forces_ and the prediction.
  void update(Particles& particles, double dt);

  StopRule stop_;
  Eigen::VectorXd mobility_;  // 1 / D [m/N], 0 for a fixed particle
  Positions predicted_;
  Positions before_;
  Forces forces_;
};

SolverRegistry::Entry jacobi_entry();

}  // namespace pliant
