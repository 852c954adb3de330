#include "pliant/solvers/linear/cholesky.h"

#include <cstring>

#include "pliant/math/error.h"
#include "pliant/math/widest.h"

namespace pliant {
namespace {

// Three right-hand sides, and a fourth that nothing uses.
using Four = double __attribute__((vector_size(4 * sizeof(double))));

/// L Lᵀ x = v in place, 4 numbers a row.
PLIANT_WIDEST void solve_factor(int n, const int* begins, const int* rows, const double* values,
                                double* v) {
  const auto at = [v](int row) { return v + 4 * static_cast<std::ptrdiff_t>(row); };
  for (int j = 0; j < n; ++j) {
    Four x;
    std::memcpy(&x, at(j), sizeof x);
    x /= values[begins[j]];
    std::memcpy(at(j), &x, sizeof x);
    for (int e = begins[j] + 1; e < begins[j + 1]; ++e) {
      Four to;
      std::memcpy(&to, at(rows[e]), sizeof to);
      to -= values[e] * x;
      std::memcpy(at(rows[e]), &to, sizeof to);
    }
  }
  for (int j = n - 1; j >= 0; --j) {
    Four sum;
    std::memcpy(&sum, at(j), sizeof sum);
    for (int e = begins[j] + 1; e < begins[j + 1]; ++e) {
      Four other;
      std::memcpy(&other, at(rows[e]), sizeof other);
      sum -= values[e] * other;
    }
    sum /= values[begins[j]];
    std::memcpy(at(j), &sum, sizeof sum);
  }
}

}  // namespace

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
  permuted_.setZero(4, a.rows());
}

void CholeskySolver::solve(Eigen::Matrix3Xd& b) {
  const int n = static_cast<int>(factor_.cols());
  for (int j = 0; j < n; ++j) permuted_.col(j).head<3>() = b.col(order_[j]);
  solve_factor(n, factor_.outerIndexPtr(), factor_.innerIndexPtr(), factor_.valuePtr(),
               permuted_.data());
  for (int j = 0; j < n; ++j) b.col(order_[j]) = permuted_.col(j).head<3>();
}

}  // namespace pliant
