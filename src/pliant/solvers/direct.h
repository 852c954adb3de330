#pragma once

#include "pliant/solvers/factored_solver.h"

namespace pliant {

/// Projective dynamics as published (Bouaziz et al. 2014): the constant matrix is factored once,
/// each iteration is one local step and one solve, x += A⁻¹ r. Factored anew only when masses,
/// fixed particles, elements or the time step change.
class DirectSolver final : public FactoredSolver {
 public:
  explicit DirectSolver(const StopRule& rule) : FactoredSolver(rule) {}
  std::string_view name() const override { return "direct"; }

 protected:
  void prepare_iterations(const ProjectiveSystem& system) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;

 private:
  CholeskySolver cholesky_;
  Eigen::Matrix3Xd product_;
  Positions start_;
};

SolverRegistry::Entry direct_entry();

}  // namespace pliant
