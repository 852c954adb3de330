#include "pliant/solvers/iterations/relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "pliant/math/symmetric_eigen.h"

namespace pliant {
namespace {

// From a start without prejudice the chance that the estimate is more than a tenth too low is below
// 1.7 sqrt(n) exp(-2 sqrt(0.1) k) after k iterations (Kuczynski and Wozniakowski 1992): 1e-5 for a
// million particles.
constexpr int kIterations = 30;
// The estimate ends below the eigenvalue, by a few percent.
constexpr double kMargin = 1.05;
// Of a vector that is round-off.
constexpr double kTinyLength = 1e-12;
// Of 2 / lambda_max, the limit of convergence.
constexpr double kShare = 0.9;

/// A matrix A as Relaxation needs it.
struct Operator {
  const Eigen::VectorXd& diagonal;
  Eigen::VectorXd absolute_row_sums;
  std::function<void(const Eigen::VectorXd& x, Eigen::VectorXd& y)> multiply;  ///< y = A x
  /// max_i of sum_j |A_ij| / A_ii, no eigenvalue of D^-1 A is above it.
  double row_sum_bound() const {
    return absolute_row_sums.cwiseQuotient(diagonal).cwiseMax(0.0).maxCoeff();
  }
};

Operator operator_of(const SparseRows& a, const Eigen::VectorXd& diagonal) {
  return {diagonal, absolute_row_sums(a),
          [&a](const Eigen::VectorXd& x, Eigen::VectorXd& y) { y = a * x; }};
}

/// A start that no symmetry of a mesh makes orthogonal to the wanted vector.
Eigen::VectorXd scattered(Eigen::Index size) {
  Eigen::VectorXd v(size);
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  for (Eigen::Index i = 0; i < size; ++i) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    v[i] = static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
  }
  return v;
}

struct Extremes {
  double least, largest;
};

/// Extreme eigenvalues of D^-1/2 A D^-1/2, from inside, by Lanczos iterations: a power iteration
/// that forgets nothing, so that one stiff place in a large soft body is not lost.
Extremes lanczos(const Operator& a) {
  const Eigen::Index size = a.diagonal.size();
  const int most = static_cast<int>(std::min<Eigen::Index>(kIterations, size));
  const Eigen::VectorXd scale = a.diagonal.cwiseSqrt().cwiseInverse();
  Eigen::VectorXd alpha(most), beta(most);
  Eigen::VectorXd v = scattered(size).normalized();
  Eigen::VectorXd last = Eigen::VectorXd::Zero(size), product;
  int k = 0;
  for (double length = 0.0; k < most; ++k) {
    a.multiply(scale.cwiseProduct(v), product);
    Eigen::VectorXd next = scale.cwiseProduct(product) - length * last;
    alpha[k] = v.dot(next);
    next -= alpha[k] * v;
    length = beta[k] = next.norm();
    if (length <= kTinyLength * alpha[k]) {
      ++k;
      break;
    }
    last.swap(v);
    v = next / length;
  }
  const Eigen::VectorXd values = tridiagonal_eigenvalues(alpha.head(k), beta.head(k - 1));
  return {values[0], values[k - 1]};
}

}  // namespace

double largest_eigenvalue(const SparseRows& a) {
  if (a.rows() == 0) return 0.0;
  const Eigen::VectorXd diagonal = a.diagonal();
  const Operator by_rows = operator_of(a, diagonal);
  return std::min(kMargin * lanczos(by_rows).largest, by_rows.row_sum_bound());
}

double Relaxation::spectral_radius(double stiffness_ratio) const {
  return std::max(1.0 - gamma / stiffness_ratio, gamma * largest_eigenvalue - 1.0);
}

namespace {

Relaxation relaxation_of(const Operator& a, const Particles& particles) {
  Relaxation relaxation;
  const Extremes extremes = lanczos(a);
  const double largest = std::min(kMargin * extremes.largest, a.row_sum_bound());
  relaxation.largest_eigenvalue = largest;
  relaxation.gamma = std::min(kShare * 2.0 / largest, 2.0 / (largest + extremes.least));
  relaxation.mobility = relaxation.gamma * free_mobility(a.diagonal, particles);
  return relaxation;
}

}  // namespace

Relaxation make_relaxation(const SparseRows& a, const Particles& particles) {
  if (a.rows() == 0) return {};
  const Eigen::VectorXd diagonal = a.diagonal();
  return relaxation_of(operator_of(a, diagonal), particles);
}

Relaxation make_relaxation(const ProjectiveProduct& a, const Particles& particles) {
  if (a.diagonal().size() == 0) return {};
  const auto multiply = [&a](const Eigen::VectorXd& x, Eigen::VectorXd& y) { a.multiply(x, y); };
  return relaxation_of({a.diagonal(), a.absolute_row_sums(), multiply}, particles);
}

}  // namespace pliant
