#pragma once

#include "pliant/solvers/constrained/held_vertices.h"
#include "pliant/solvers/iterations/projective_solver.h"
#include "pliant/solvers/iterations/step_objective.h"
#include "pliant/solvers/iterations/stop_check.h"

namespace pliant {

/// Extended position-based dynamics (Macklin et al. 2016): implicit Euler by Gauss-Seidel sweeps
/// over compliant constraints, colour by colour, multipliers kept within the step.
class XpbdSolver final : public ProjectiveSolver {
 public:
  explicit XpbdSolver(const StopRule& rule) : ProjectiveSolver(rule) {}
  std::string_view name() const override { return "xpbd"; }
  InLockstep in_lockstep() const override { return InLockstep::kSweeps; }

 protected:
  // Its displacements are forces times h²/m.
  bool loses_momentum(const ProjectiveSystem& /*system*/) const override { return false; }
  void prepare_system(const ProjectiveSystem& system, double dt) override;
  void solve(ProjectiveSystem& system, double dt, StepReport& report) override;

 private:
  friend class LockstepSolver;  // takes its sweeps in turn with the iterations of others

  HeldVertices held_;
  Eigen::VectorXd mobility_;  // h² / m [m/N]
  StepObjective objective_;   // for the residual and the energy
  Forces forces_;
};

SolverRegistry::Entry xpbd_entry();

}  // namespace pliant
