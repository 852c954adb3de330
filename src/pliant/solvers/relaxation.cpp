#include "pliant/solvers/relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pliant {
namespace {

constexpr int kMaxPowerIterations = 60;
constexpr double kPowerTolerance = 1e-3;  // relative change of the eigenvalue between iterations
// A power iteration ends below the eigenvalue, by a few times its last change.
constexpr double kMargin = 1.05;
// Of 2 / lambda_max, the limit of convergence.
constexpr double kShare = 0.9;

/// max_i of sum_j |A_ij| / A_ii, no eigenvalue of D^-1 A is above it.
double row_sum_bound(const SparseRows& a, const Eigen::VectorXd& diagonal) {
  double bound = 0.0;
  for (int i = 0; i < a.rows(); ++i) {
    double sum = 0.0;
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) sum += std::abs(entry.value());
    bound = std::max(bound, sum / diagonal[i]);
  }
  return bound;
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

/// Largest eigenvalue of D^-1/2 A D^-1/2, from below.
double power_iteration(const SparseRows& a, const Eigen::VectorXd& diagonal) {
  const Eigen::VectorXd scale = diagonal.cwiseSqrt().cwiseInverse();
  Eigen::VectorXd v = scattered(a.rows()).normalized();
  double last = 0.0;
  for (int k = 0; k < kMaxPowerIterations; ++k) {
    v = scale.cwiseProduct(a * scale.cwiseProduct(v));
    const double value = v.norm();
    v /= value;
    if (std::abs(value - last) <= kPowerTolerance * value) return value;
    last = value;
  }
  return last;
}

}  // namespace

Relaxation make_relaxation(const SparseRows& a, const Particles& particles) {
  Relaxation relaxation;
  if (a.rows() == 0) return relaxation;
  const Eigen::VectorXd diagonal = a.diagonal();
  relaxation.largest_eigenvalue =
      std::min(kMargin * power_iteration(a, diagonal), row_sum_bound(a, diagonal));
  relaxation.gamma = kShare * 2.0 / relaxation.largest_eigenvalue;
  relaxation.mobility = relaxation.gamma * free_mobility(diagonal, particles);
  return relaxation;
}

}  // namespace pliant
