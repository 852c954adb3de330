#include "pliant/math/dense_factors.h"

#include <Eigen/LU>

namespace pliant {

bool DenseCholesky::compute(const Eigen::MatrixXd& a) {
  factor_.compute(a);
  return factor_.info() == Eigen::Success;
}

Eigen::VectorXd DenseCholesky::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd DenseCholesky::solve(const Eigen::MatrixXd& b) const { return factor_.solve(b); }

void DenseCholesky::solve_in_place(Eigen::VectorXd& b) const { factor_.solveInPlace(b); }

Eigen::MatrixXd DenseCholesky::divided_by_upper(const Eigen::MatrixXd& b) const {
  return factor_.matrixU().solve<Eigen::OnTheRight>(b);
}

void DenseLdlt::compute(const Eigen::MatrixXd& a) { factor_.compute(a); }

Eigen::VectorXd DenseLdlt::solve(const Eigen::VectorXd& b) const { return factor_.solve(b); }

Eigen::MatrixXd DenseLdlt::solve(const Eigen::MatrixXd& b) const { return factor_.solve(b); }

void DenseLdlt::solve_in_place(Eigen::VectorXd& b) const { factor_.solveInPlace(b); }

Eigen::VectorXd solve_dense(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.partialPivLu().solve(b);
}

}  // namespace pliant
