#include "pliant/effects/strain_limit/yarn_constraints.h"

#include <algorithm>

namespace pliant {
namespace {
// Where a multiplier comes to its bound, Gauss-Seidel over the few.
constexpr int kBoundedSweeps = 30;
}  // namespace

double YarnConstraints::Row::of(const Eigen::Matrix3Xd& moved) const {
  double sum = 0.0;
  for (const auto& entry : entries) sum += entry.gradient.dot(moved.col(entry.particle));
  return sum;
}

void YarnConstraints::add_row(const LinearConstraint& condition, const Eigen::VectorXd& inertia,
                              const Eigen::Matrix3Xd& moved, CholeskySolver& factor) {
  if (count_ == rows_.size()) rows_.emplace_back();
  Row& row = rows_[count_++];
  row.entries = condition.entries;
  row.least = condition.least / scale_;
  row.most = condition.most / scale_;
  row.response.setZero(3, inertia.size());
  for (auto& entry : row.entries) {
    if (inertia[entry.particle] == 0.0) entry.gradient.setZero();
    row.response.col(entry.particle) = entry.gradient;
  }
  row.target = condition.target + row.of(moved);
  factor.solve(row.response);
}

void YarnConstraints::take(const LinearConstraints& conditions, const Eigen::VectorXd& inertia,
                           double scale, const Eigen::Matrix3Xd& moved, CholeskySolver& factor) {
  scale_ = scale;
  count_ = 0;
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    add_row(conditions[k], inertia, moved, factor);
  }
  const auto most = static_cast<Eigen::Index>(rows_.size());
  responses_.setIdentity(most, most);
  for (std::size_t a = 0; a < count_; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    for (std::size_t b = 0; b < count_; ++b) {
      responses_(i, static_cast<Eigen::Index>(b)) = rows_[a].of(rows_[b].response);
    }
    responses_(i, i) += scale * conditions[a].compliance;
  }
  if (count_ > 0) inverse_.compute(responses_);
  multipliers_.setZero(most);
  missed_.setZero(most);
}

void YarnConstraints::apply(Eigen::Matrix3Xd& moved) {
  if (count_ == 0) return;
  const auto count = static_cast<Eigen::Index>(count_);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Row& row = rows_[static_cast<std::size_t>(a)];
    missed_[a] = row.target - row.of(moved);
  }
  multipliers_ = missed_;
  inverse_.solve_in_place(multipliers_);
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

void YarnConstraints::add_forces(const Eigen::VectorXd& mobility, Positions& x) const {
  for (std::size_t r = 0; r < count_; ++r) {
    const double force = change(r);
    for (const auto& entry : rows_[r].entries) {
      x.col(entry.particle) += (mobility[entry.particle] * force) * entry.gradient;
    }
  }
}

}  // namespace pliant
