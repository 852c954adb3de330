#pragma once

#include "pliant/solvers/implicit_euler.h"
#include "pliant/solvers/relaxation.h"
#include "pliant/solvers/rigid_part.h"

namespace pliant {

/// Jacobi in which strongly deformed places speak louder, so that deformation travels further in
/// one iteration: x += α W D⁻¹ r with weights W by how far each particle wants to move, and the α
/// that minimises the projective step's quadratic bound along that direction. Any weights then
/// lower the objective, and the answer at convergence is that of all the others.
///
/// Weights leave momentum behind, however few the iterations are that should bring it back. It is
/// kept where each iteration moves without the rigid part, about where the step would go without
/// forces between particles: then Σ m x is what it was, and Σ m x × (x − y) = 0 as at convergence.
class WeightedJacobiSolver final : public ImplicitEulerSolver {
 public:
  WeightedJacobiSolver(const StopRule& rule, double spread, bool keeps_momentum)
      : ImplicitEulerSolver(rule), spread_(spread), keeps_momentum_(keeps_momentum) {}
  std::string_view name() const override { return "weighted_jacobi"; }

 protected:
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;
  const Eigen::VectorXd& mobility() const override { return relaxation_.mobility; }

 private:
  void weigh();
  double best_step();

  bool is_free(const ProjectiveSystem& system) const;

  double spread_;  // largest weight, and one over the smallest
  bool keeps_momentum_;
  bool is_free_ = false;  // nothing holds the system
  RigidPart rigid_part_;
  Relaxation relaxation_;
  Positions direction_;  // W γ D⁻¹ r [m]
  Forces product_;       // A times direction_ [N]
  double step_ = 1.0;    // α of the last iteration
};

SolverRegistry::Entry weighted_jacobi_entry();

}  // namespace pliant
