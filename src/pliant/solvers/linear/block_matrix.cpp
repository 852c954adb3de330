#include "pliant/solvers/linear/block_matrix.h"

#include <algorithm>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/linear/block_products.h"

namespace pliant {
namespace {
constexpr int kGrain = 512;
}  // namespace

void BlockMatrix::begin(const Particles& particles, const Eigen::VectorXd& inertia) {
  particles_ = &particles;
  added_ = 0;
  const int n = particles.size();
  if (size() != n) {
    begins_.resize(static_cast<std::size_t>(n) + 1);
    columns_.resize(static_cast<std::size_t>(n));
    diagonals_.resize(static_cast<std::size_t>(n));
    blocks_.resize(static_cast<std::size_t>(n) + 1);
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      begins_[at] = columns_[at] = diagonals_[at] = i;
    }
    begins_.back() = n;
  }
  for (Eigen::Matrix3d& block : blocks_) block.setZero();
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(diagonals_[static_cast<std::size_t>(i)]);
    blocks_[at].diagonal().setConstant(inertia[i]);
  }
}

int BlockMatrix::find(int row, int column) const {
  const auto first = columns_.begin() + begin(row), last = columns_.begin() + end(row);
  const auto found = std::lower_bound(first, last, column);
  return found != last && *found == column ? static_cast<int>(found - columns_.begin()) : -1;
}

void BlockMatrix::add(int row, int column, const Eigen::Matrix3d& block) {
  if (particles_->is_fixed(row) || particles_->is_fixed(column)) return;
  // The same blocks come in the same order, assembly for assembly, but for those that are new.
  if (added_ == found_.size()) found_.push_back(-1);
  int& entry = found_[added_++];
  if (entry < begin(row) || entry >= end(row) || this->column(entry) != column) {
    entry = find(row, column);
  }
  if (entry < 0) {
    strays_.emplace_back(row, column);
  } else {
    blocks_[static_cast<std::size_t>(entry)] += block;
  }
}

bool BlockMatrix::finish() {
  if (strays_.empty()) return true;
  widen_pattern();
  return false;
}

void BlockMatrix::widen_pattern() {
  for (int row = 0; row < size(); ++row) {
    for (int entry = begin(row); entry < end(row); ++entry) {
      strays_.emplace_back(row, column(entry));
    }
  }
  std::sort(strays_.begin(), strays_.end());
  strays_.erase(std::unique(strays_.begin(), strays_.end()), strays_.end());
  const int n = size();
  columns_.clear();
  begins_.assign(1, 0);
  std::size_t next = 0;
  for (int row = 0; row < n; ++row) {
    for (; next < strays_.size() && strays_[next].first == row; ++next) {
      const int column = strays_[next].second;
      if (column == row) diagonals_[static_cast<std::size_t>(row)] = static_cast<int>(next);
      columns_.push_back(column);
    }
    begins_.push_back(static_cast<int>(next));
  }
  blocks_.assign(columns_.size() + 1, Eigen::Matrix3d::Zero());
  strays_.clear();
  strays_.shrink_to_fit();
}

void BlockMatrix::multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const {
  y.resize(3, v.cols());
  parallel_for(0, size(), kGrain, [&](int first, int last) {
    multiply_block_rows(first, last, begins_.data(), columns_.data(), blocks_.front().data(),
                        v.data(), y.data());
  });
}

}  // namespace pliant
