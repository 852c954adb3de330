#include "pliant/solvers/linear/projective_matrix.h"

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/linear/free_entries.h"

namespace pliant {
namespace {

constexpr int kGrain = 256;

}  // namespace

SparseRows projective_matrix(const ProjectiveSystem& system, double dt) {
  return FreeEntries(system.particles).matrix(system, dt);
}

void multiply(const SparseRows& a, const Positions& x, Positions& y) {
  const int* begins = a.outerIndexPtr();
  const int* columns = a.innerIndexPtr();
  const double* values = a.valuePtr();
  y.resize(3, x.cols());
  parallel_for(0, static_cast<int>(x.cols()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (int e = begins[i]; e < begins[i + 1]; ++e) sum += values[e] * x.col(columns[e]);
      y.col(i) = sum;
    }
  });
}

Eigen::VectorXd absolute_row_sums(const SparseRows& a) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(a.rows());
  for (int i = 0; i < a.rows(); ++i) {
    for (SparseRows::InnerIterator entry(a, i); entry; ++entry) sums[i] += std::abs(entry.value());
  }
  return sums;
}

Eigen::VectorXd free_mobility(const Eigen::VectorXd& diagonal, const Particles& particles) {
  Eigen::VectorXd mobility = diagonal.cwiseInverse();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) mobility[i] = 0.0;
  }
  return mobility;
}

}  // namespace pliant
