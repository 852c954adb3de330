#pragma once

#include "pliant/solvers/iterations/implicit_euler.h"
#include "pliant/solvers/iterations/relaxation.h"

namespace pliant {

/// Jacobi in which strongly deformed places speak louder, so that deformation travels further in
/// one iteration: x += α W D⁻¹ r with weights W by how far each particle wants to move, and the α
/// that minimises the projective step's quadratic bound along that direction. Any weights then
/// lower the objective, and the answer at convergence is that of all the others.
class LineSearchJacobiSolver final : public ImplicitEulerSolver {
 public:
  LineSearchJacobiSolver(const StopRule& rule, double spread)
      : ImplicitEulerSolver(rule), spread_(spread) {}
  std::string_view name() const override { return "line_search_jacobi"; }

 protected:
  bool needs_matrix() const override { return true; }
  void prepare_iterations(const ProjectiveSystem& system) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  const Eigen::VectorXd& mobility() const override { return relaxation_.mobility; }

 private:
  void weigh();
  double best_step();

  double spread_;  // largest weight, and one over the smallest
  Relaxation relaxation_;
  Positions direction_;  // W γ D⁻¹ r [m]
  Forces product_;       // A times direction_ [N]
  double step_ = 1.0;    // α of the last iteration
};

SolverRegistry::Entry line_search_jacobi_entry();

}  // namespace pliant
