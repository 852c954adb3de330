#pragma once

#include "pliant/solvers/factored_solver.h"

namespace pliant {

/// Newton's method with line search: the reference that the others are measured against. It takes
/// the exact Hessian where that is positive definite, and the one with every element's part made
/// positive semi-definite (Teran et al. 2005) where it is not.
class NewtonSolver final : public FactoredSolver {
 public:
  explicit NewtonSolver(const StopRule& rule) : FactoredSolver(rule) {}
  std::string_view name() const override { return "newton"; }

 protected:
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  void assemble(const ProjectiveSystem& system, Definiteness definiteness);
  bool factor(const ProjectiveSystem& system);
  void solve(Eigen::Matrix3Xd& v) const;
  void apply(Eigen::Matrix3Xd& v) const;

  std::vector<Eigen::Triplet<double>> entries_;
  Matrix hessian_;
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>> llt_;
  Eigen::Index analyzed_ = -1;  // entries of the matrix whose pattern llt_ knows
  Positions start_;
  int projected_ = 0;  // iterations that took the projected Hessian
};

SolverRegistry::Entry newton_entry();

}  // namespace pliant
