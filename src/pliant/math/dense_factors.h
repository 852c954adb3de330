#pragma once

#include <Eigen/Cholesky>

/// Factors of dense matrices of any size, by Eigen: compiled once, since they take the compiler
/// seconds in every file that uses them. Right sides are a column or several; sizes must fit.
namespace pliant {

/// L Lᵀ = A of a symmetric positive definite matrix, of which the lower half is read.
class DenseCholesky {
 public:
  DenseCholesky() = default;
  explicit DenseCholesky(const Eigen::MatrixXd& a) { compute(a); }

  /// False if `a` is not positive definite; nothing can be solved then.
  bool compute(const Eigen::MatrixXd& a);

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  void solve_in_place(Eigen::VectorXd& b) const;
  /// B (Lᵀ)⁻¹.
  Eigen::MatrixXd divided_by_upper(const Eigen::MatrixXd& b) const;

 private:
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

/// L D Lᵀ = A with pivoting, of a symmetric semidefinite matrix, of which the lower half is read:
/// where A is singular, one of many solutions.
class DenseLdlt {
 public:
  DenseLdlt() = default;
  explicit DenseLdlt(const Eigen::MatrixXd& a) { compute(a); }

  void compute(const Eigen::MatrixXd& a);

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  void solve_in_place(Eigen::VectorXd& b) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> factor_;
};

/// x of A x = b, of any regular matrix, by LU with row pivoting.
Eigen::VectorXd solve_dense(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

}  // namespace pliant
