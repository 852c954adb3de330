#include "pliant/effects/thread_conditions.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace pliant {
namespace {
// Where a multiplier comes to its bound, Gauss-Seidel over the few.
constexpr int kBoundedSweeps = 30;
}  // namespace

double ThreadConditions::Row::of(const Eigen::Matrix3Xd& moved) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < particles.size(); ++k) {
    sum += gradient.col(static_cast<Eigen::Index>(k)).dot(moved.col(particles[k]));
  }
  return sum;
}

void ThreadConditions::take(const std::vector<KeptCondition>& conditions,
                            const Eigen::VectorXd& inertia, double scale,
                            const Eigen::Matrix3Xd& moved, CholeskySolver& factor) {
  scale_ = scale;
  rows_.clear();
  for (const KeptCondition& condition : conditions) {
    Row row{condition.particles,     condition.gradient,     0.0,
            condition.least / scale, condition.most / scale, {}};
    row.response.setZero(3, inertia.size());
    for (std::size_t k = 0; k < row.particles.size(); ++k) {
      const int i = row.particles[k];
      auto own = row.gradient.col(static_cast<Eigen::Index>(k));
      if (inertia[i] == 0.0) own.setZero();
      row.response.col(i) = own;
    }
    row.target = condition.target + row.of(moved);
    factor.solve(row.response);
    rows_.push_back(std::move(row));
  }
  const auto count = static_cast<Eigen::Index>(rows_.size());
  responses_.resize(count, count);
  for (Eigen::Index a = 0; a < count; ++a) {
    for (Eigen::Index b = 0; b < count; ++b) {
      responses_(a, b) =
          rows_[static_cast<std::size_t>(a)].of(rows_[static_cast<std::size_t>(b)].response);
    }
    responses_(a, a) += scale * conditions[static_cast<std::size_t>(a)].compliance;
  }
  multipliers_.setZero(count);
  missed_.resize(count);
}

void ThreadConditions::apply(Eigen::Matrix3Xd& moved) {
  if (rows_.empty()) return;
  const auto count = static_cast<Eigen::Index>(rows_.size());
  for (Eigen::Index a = 0; a < count; ++a) {
    const Row& row = rows_[static_cast<std::size_t>(a)];
    missed_[a] = row.target - row.of(moved);
  }
  multipliers_ = responses_.ldlt().solve(missed_);
  const auto bounded = [&](Eigen::Index a, double value) {
    const Row& row = rows_[static_cast<std::size_t>(a)];
    return std::clamp(value, row.least, row.most);
  };
  bool is_within = true;
  for (Eigen::Index a = 0; a < count; ++a) {
    const double own = bounded(a, multipliers_[a]);
    is_within = is_within && own == multipliers_[a];
    multipliers_[a] = own;
  }
  for (int k = 0; k < kBoundedSweeps && !is_within; ++k) {
    for (Eigen::Index a = 0; a < count; ++a) {
      const double left = missed_[a] - responses_.row(a).dot(multipliers_);
      if (responses_(a, a) > 0.0) {
        multipliers_[a] = bounded(a, multipliers_[a] + left / responses_(a, a));
      }
    }
  }
  for (Eigen::Index a = 0; a < count; ++a) {
    moved += multipliers_[a] * rows_[static_cast<std::size_t>(a)].response;
  }
}

void ThreadConditions::add_forces(const Eigen::VectorXd& mobility, Positions& x) const {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    const Row& row = rows_[r];
    const double force = scale_ * multipliers_[static_cast<Eigen::Index>(r)];
    for (std::size_t k = 0; k < row.particles.size(); ++k) {
      const int i = row.particles[k];
      x.col(i) += (mobility[i] * force) * row.gradient.col(static_cast<Eigen::Index>(k));
    }
  }
}

}  // namespace pliant
