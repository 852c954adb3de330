#include "pliant/solvers/linear/cholesky.h"

#include "pliant/math/error.h"

namespace pliant {

void CholeskySolver::factor(const SparseRows& a) {
  using Column = Eigen::SparseMatrix<double>;
  Eigen::SimplicialLLT<Column, Eigen::Lower, Eigen::AMDOrdering<int>> llt;
  llt.compute(Column(a));
  if (llt.info() != Eigen::Success) {
    throw InputError(
        "the system of masses and stiffnesses is not positive definite to round-off: stiffnesses "
        "differ by too much; take a smaller time step, or the solver jacobi or xpbd");
  }
  factor_ = llt.matrixL();
  order_ = llt.permutationPinv().indices();
  permuted_.resize(3, a.rows());
}

void CholeskySolver::solve(Eigen::Matrix3Xd& b) {
  const int* begins = factor_.outerIndexPtr();
  const int* rows = factor_.innerIndexPtr();
  const double* values = factor_.valuePtr();
  const int n = static_cast<int>(factor_.cols());
  for (int j = 0; j < n; ++j) permuted_.col(j) = b.col(order_[j]);
  for (int j = 0; j < n; ++j) {
    const Eigen::Vector3d x = permuted_.col(j) / values[begins[j]];
    permuted_.col(j) = x;
    for (int e = begins[j] + 1; e < begins[j + 1]; ++e) permuted_.col(rows[e]) -= values[e] * x;
  }
  for (int j = n - 1; j >= 0; --j) {
    Eigen::Vector3d sum = permuted_.col(j);
    for (int e = begins[j] + 1; e < begins[j + 1]; ++e) sum -= values[e] * permuted_.col(rows[e]);
    permuted_.col(j) = sum / values[begins[j]];
    b.col(order_[j]) = permuted_.col(j);
  }
}

}  // namespace pliant
