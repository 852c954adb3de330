#include "pliant/solvers/linear/multigrid.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/symmetric_eigen.h"
#include "pliant/solvers/iterations/relaxation.h"

namespace pliant {
namespace {

constexpr int kGrain = 256;

Eigen::Vector3d product_of_row(const SparseRows& a, int i, const Eigen::Matrix3Xd& v) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (SparseRows::InnerIterator entry(a, i); entry; ++entry) {
    sum += entry.value() * v.col(entry.col());
  }
  return sum;
}

/// to <- use(i) for each column.
template <class Use>
void fill(Eigen::Matrix3Xd& to, const Use& use) {
  parallel_for(0, static_cast<int>(to.cols()), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) to.col(i) = use(i);
  });
}

/// All sweeps of a level from z; `before` is memory.
void smooth(const MultigridLevel& level, const Eigen::Matrix3Xd& q, Eigen::Matrix3Xd& z,
            Eigen::Matrix3Xd& before) {
  for (std::size_t k = 0; k < level.smoother.pull.size(); ++k) {
    const double momentum = level.smoother.momentum[k], pull = level.smoother.pull[k];
    Eigen::Matrix3Xd next(3, z.cols());
    fill(next, [&](int i) -> Eigen::Vector3d {
      const Eigen::Vector3d left = q.col(i) - product_of_row(level.a, i, z);
      const Eigen::Vector3d step = (pull / level.diagonal[i]) * left;
      if (momentum == 0.0) return z.col(i) + step;
      return z.col(i) + momentum * (z.col(i) - before.col(i)) + step;
    });
    before.swap(z);
    z.swap(next);
  }
}

/// As many sweeps as there are for the smallest eigenvalue, or for what so many can reach: they
/// leave a third there, and more of those below.
Smoother coarsest_smoother(const MultigridLevel& level, double largest) {
  constexpr double kReach = 0.77;
  constexpr int kSweeps = Multigrid::kCoarsestSweeps;
  const Eigen::VectorXd scale = level.diagonal.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * Eigen::MatrixXd(level.a) * scale.asDiagonal();
  const double reached = kReach * largest / (kSweeps * kSweeps);
  return make_smoother(std::max(symmetric_eigenvalues(scaled)[0], reached), largest, kSweeps);
}

}  // namespace

Smoother make_smoother(double least, double largest, int sweeps) {
  // Saad 2003, algorithm 12.1.
  const double middle = 0.5 * (largest + least);
  const double half = std::max(0.5 * (largest - least), 1e-6 * middle);
  double rho = half / middle;
  Smoother smoother = {{0.0}, {1.0 / middle}};
  for (int k = 1; k < sweeps; ++k) {
    const double last = rho;
    rho = 1.0 / (2.0 * middle / half - last);
    smoother.momentum.push_back(rho * last);
    smoother.pull.push_back(2.0 * rho / half);
  }
  return smoother;
}

Multigrid::Multigrid(SparseRows a, double largest) {
  while (a.rows() > 0) {
    MultigridLevel& level = levels_.emplace_back();
    const bool is_finest = levels_.size() == 1;
    level.a.swap(a);
    level.diagonal = level.a.diagonal();
    if (!is_finest || !(largest > 0.0)) largest = largest_eigenvalue(level.a);
    level.is_coarsest = !is_finest && level.a.rows() <= kMostCoarsest;
    if (level.is_coarsest) {
      level.smoother = coarsest_smoother(level, largest);
      break;
    }
    level.smoother = make_smoother(largest / Smoother::kRange, largest, Smoother::kSweeps);
    level.prolongation = smoothed_prolongation(level.a, aggregate(level.a));
    level.restriction = level.prolongation.transpose();
    a = product(level.restriction, product(level.a, level.prolongation));
  }
}

double Multigrid::complexity() const {
  if (levels_.empty()) return 1.0;
  double sum = 0.0;
  for (const MultigridLevel& level : levels_) sum += static_cast<double>(level.a.nonZeros());
  return sum / static_cast<double>(levels_.front().a.nonZeros());
}

void Multigrid::solve(Eigen::Matrix3Xd& v) const {
  if (!levels_.empty()) v = cycle(0, v);
}

Eigen::Matrix3Xd Multigrid::cycle(std::size_t number, const Eigen::Matrix3Xd& q) const {
  const MultigridLevel& level = levels_[number];
  Eigen::Matrix3Xd z = Eigen::Matrix3Xd::Zero(3, q.cols()), before = z;
  smooth(level, q, z, before);
  if (level.is_coarsest) return z;
  if (level.has_coarser()) {
    Eigen::Matrix3Xd left(3, q.cols()), coarse(3, level.prolongation.cols());
    fill(left, [&](int i) { return (q.col(i) - product_of_row(level.a, i, z)).eval(); });
    fill(coarse, [&](int c) { return product_of_row(level.restriction, c, left); });
    const Eigen::Matrix3Xd found = cycle(number + 1, coarse);
    fill(z,
         [&](int i) { return (z.col(i) + product_of_row(level.prolongation, i, found)).eval(); });
  }
  smooth(level, q, z, before);
  return z;
}

}  // namespace pliant
