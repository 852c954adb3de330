#include "pliant/models/reduced/reduced_basis.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <Eigen/SparseCholesky>

#include "pliant/math/dense_factors.h"
#include "pliant/math/error.h"
#include "pliant/math/symmetric_eigen.h"

namespace pliant {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Left singular vectors of Lᵀ P X taken back, M = Pᵀ L Lᵀ P: X's principal directions in the norm
/// of M, without squaring their condition as the eigenvectors of Xᵀ M X would.
Eigen::MatrixXd principal_directions(const Eigen::MatrixXd& x, const Sparse& mass, int rank) {
  const Eigen::SimplicialLLT<Sparse> factor(mass);
  const Eigen::MatrixXd y = factor.matrixU() * (factor.permutationP() * x);
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(y, Eigen::ComputeThinU);
  constexpr double kIndependent = 1e-12;
  Eigen::Index independent = 0;
  while (independent < svd.singularValues().size() &&
         svd.singularValues()[independent] > kIndependent * svd.singularValues()[0]) {
    ++independent;
  }
  if (rank < 1 || rank > independent) {
    throw InputError(fmt::format(
        "rank is {}, but must be from 1 to {}: modes and their derivatives span no more; take more "
        "modes",
        rank, independent));
  }
  const Eigen::MatrixXd left = svd.matrixU().leftCols(rank);
  return factor.permutationPinv() * factor.matrixU().solve(left);
}

}  // namespace

Eigen::MatrixXd modal_derivatives(const StvkBody& body, const LinearModes& modes,
                                  const StaticResponse& response, const ReduceProgress& progress) {
  const auto k = static_cast<int>(modes.shapes.cols());
  Eigen::MatrixXd derivatives(body.size(), k * (k + 1) / 2);
  int column = 0;
  for (int j = 0; j < k; ++j) {
    for (int i = 0; i <= j; ++i, ++column) {
      if (!progress(column, static_cast<double>(derivatives.cols()), "modal derivatives"))
        return {};
      derivatives.col(column) =
          -response.solve(body.second_derivative(modes.shapes.col(i), modes.shapes.col(j)));
    }
  }
  return derivatives;
}

ReducedBasis mass_pca(const LinearModes& modes, const Eigen::MatrixXd& derivatives,
                      const Sparse& stiffness, const Sparse& mass, int rank) {
  const Eigen::Index k = modes.shapes.cols();
  Eigen::MatrixXd x(modes.shapes.rows(), k + derivatives.cols());
  const double first = modes.lambda[0];
  Eigen::Index column = k;
  for (Eigen::Index j = 0; j < k; ++j) {
    x.col(j) = modes.shapes.col(j) * (first / modes.lambda[j]);
    for (Eigen::Index i = 0; i <= j; ++i, ++column) {
      x.col(column) =
          derivatives.col(column - k) * (first * first / (modes.lambda[i] * modes.lambda[j]));
    }
  }
  return diagonalise(principal_directions(x, mass, rank), stiffness, mass);
}

ReducedBasis diagonalise(const Eigen::MatrixXd& columns, const Sparse& stiffness,
                         const Sparse& mass) {
  Eigen::MatrixXd u = columns;
  for (int pass = 0; pass < 2; ++pass) {  // the second takes off what round-off left
    const Eigen::MatrixXd gram = u.transpose() * (mass * u);
    u = DenseCholesky(gram).divided_by_upper(u);
  }
  const Eigen::MatrixXd k = u.transpose() * (stiffness * u);
  const SymmetricEigen eigen = symmetric_eigen(0.5 * (k + k.transpose()));
  ReducedBasis basis{u * eigen.vectors, eigen.values};
  for (Eigen::Index c = 0; c < basis.u.cols(); ++c) {
    Eigen::Index row = 0;
    basis.u.col(c).cwiseAbs().maxCoeff(&row);
    if (basis.u(row, c) < 0.0) basis.u.col(c) *= -1.0;
  }
  return basis;
}

}  // namespace pliant
