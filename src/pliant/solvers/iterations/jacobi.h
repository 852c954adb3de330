#pragma once

#include "pliant/solvers/iterations/implicit_euler.h"
#include "pliant/solvers/iterations/relaxation.h"

namespace pliant {

/// Projective dynamics by Jacobi iterations: x += γ D⁻¹ r. Under-relaxed by γ, so that no iteration
/// raises the step's objective, whatever the mesh.
class JacobiSolver final : public ImplicitEulerSolver {
 public:
  explicit JacobiSolver(const StopRule& rule) : ImplicitEulerSolver(rule) {}
  std::string_view name() const override { return "jacobi"; }

 protected:
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  const Eigen::VectorXd& mobility() const override { return relaxation_.mobility; }

 private:
  Relaxation relaxation_;
};

SolverRegistry::Entry jacobi_entry();

}  // namespace pliant
