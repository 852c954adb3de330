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
  void prepare_iterations(const ProjectiveSystem& system) override;
  void begin_iterations(ProjectiveSystem& system, StepReport& report) override;
  bool iterate(ProjectiveSystem& system, StepReport& report) override;
  void end_iterations(ProjectiveSystem& system, StepReport& report) override;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  bool iterate_with_constraints(ProjectiveSystem& system, StepReport& report);
  /// v <- (H + Jᵀ C⁻¹ J)⁻¹ v; false where that matrix is not positive definite.
  bool solve_with(const ConstraintRows& rows, Eigen::Matrix3Xd& v);
  void add_block(int row, int column, const Eigen::Matrix3d& block);
  void analyze(const Matrix& matrix);
  void assemble(const ProjectiveSystem& system, Definiteness definiteness);
  bool factor(const ProjectiveSystem& system);
  void solve(Eigen::Matrix3Xd& v) const;
  void apply(Eigen::Matrix3Xd& v) const;

  std::vector<Eigen::Triplet<double>> entries_;
  Matrix hessian_;
  Eigen::SimplicialLLT<Matrix, Eigen::Lower, Eigen::AMDOrdering<int>> llt_;
  static constexpr Eigen::Index kUnknown = -1;
  Eigen::Index analyzed_ = kUnknown;  // entries of the matrix whose pattern llt_ knows
  Matrix with_rows_;
  Eigen::VectorXd mobility_of_constraints_;
  bool takes_exact_ = true;  // the next iteration under constraints
  Positions start_;
  int projected_ = 0;  // iterations that took the projected Hessian
};

SolverRegistry::Entry newton_entry();

}  // namespace pliant
