#include "pliant/solvers/linear/block_matrix.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/core/parallel/parallel.h"
#include "pliant/solvers/linear/block_products.h"

namespace pliant {
namespace {
constexpr int kGrain = 64;
// Where no entry is known yet.
constexpr int kNone = std::numeric_limits<int>::max();
// Up to so many particles that share a stiffness have blocks of their own, which cost no more than
// their common motions.
constexpr std::size_t kFewShared = 8;
}  // namespace

int BlockMatrix::Pattern::find(int row, int of) const {
  const auto first = columns.begin() + begin(row), last = columns.begin() + end(row);
  const auto found = std::lower_bound(first, last, of);
  return found != last && *found == of ? static_cast<int>(found - columns.begin()) : -1;
}

void BlockMatrix::Pattern::append_to(Places& places) const {
  for (int row = 0; row < rows(); ++row) {
    for (int entry = begin(row); entry < end(row); ++entry) {
      places.emplace_back(row, column(entry));
    }
  }
}

void BlockMatrix::Pattern::take(int rows, Places& places) {
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());
  columns.clear();
  begins.assign(1, 0);
  std::size_t next = 0;
  for (int row = 0; row < rows; ++row) {
    for (; next < places.size() && places[next].first == row; ++next) {
      columns.push_back(places[next].second);
    }
    begins.push_back(static_cast<int>(next));
  }
}

void BlockMatrix::begin(const Particles& particles, const Eigen::VectorXd& inertia) {
  particles_ = &particles;
  added_ = 0;
  const int n = particles.size();
  if (size() != n) {
    Places diagonal;
    for (int i = 0; i < n; ++i) diagonal.emplace_back(i, i);
    blocks_at_.take(n, diagonal);
    diagonals_ = blocks_at_.columns;
    blocks_.resize(static_cast<std::size_t>(n) + 1);
    Places none;
    scalars_at_.take(n, none);
    scalars_.clear();
  }
  shared_.begin_assembly(n);
  for (Eigen::Matrix3d& block : blocks_) block.setZero();
  std::fill(scalars_.begin(), scalars_.end(), 0.0);
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(diagonals_[static_cast<std::size_t>(i)]);
    blocks_[at].diagonal().setConstant(inertia[i]);
  }
}

void BlockMatrix::add(int row, int column, const Eigen::Matrix3d& block) {
  if (particles_->is_fixed(row) || particles_->is_fixed(column)) return;
  // The same blocks come in the same order, assembly for assembly, but for those that are new.
  if (added_ == found_.size()) found_.push_back(kNone);
  int& entry = found_[added_++];
  if (!blocks_at_.is_at(entry, row, column)) {
    const int found = blocks_at_.find(row, column);
    if (found < 0) {
      stray_blocks_.emplace_back(row, column);
      return;
    }
    entry = found;
  }
  blocks_[static_cast<std::size_t>(entry)] += block;
}

void BlockMatrix::add_isotropic(int row, int column, double stiffness) {
  if (particles_->is_fixed(row) || particles_->is_fixed(column)) return;
  if (added_ == found_.size()) found_.push_back(kNone);
  int& entry = found_[added_++];
  if (!scalars_at_.is_at(~entry, row, column) && !blocks_at_.is_at(entry, row, column)) {
    const int block = blocks_at_.find(row, column);
    const int scalar = block < 0 ? scalars_at_.find(row, column) : -1;
    if (block < 0 && scalar < 0) {
      stray_scalars_.emplace_back(row, column);
      return;
    }
    entry = block < 0 ? ~scalar : block;
  }
  if (entry < 0) {
    scalars_[static_cast<std::size_t>(~entry)] += stiffness;
  } else {
    blocks_[static_cast<std::size_t>(entry)].diagonal().array() += stiffness;
  }
}

void BlockMatrix::add_shared(const SharedStiffness& shared) {
  if (shared.members.size() <= kFewShared) {
    StiffnessMatrix::add_shared(shared);
  } else {
    shared_.add(shared, *particles_);
  }
}

bool BlockMatrix::finish() {
  shared_.finish();
  if (stray_blocks_.empty() && stray_scalars_.empty()) return true;
  widen_pattern();
  return false;
}

void BlockMatrix::widen_pattern() {
  const int n = size();
  blocks_at_.append_to(stray_blocks_);
  blocks_at_.take(n, stray_blocks_);
  for (int row = 0; row < n; ++row) {
    diagonals_[static_cast<std::size_t>(row)] = blocks_at_.find(row, row);
  }
  blocks_.assign(static_cast<std::size_t>(blocks_at_.size()) + 1, Eigen::Matrix3d::Zero());
  scalars_at_.append_to(stray_scalars_);
  const auto has_block = [this](const auto& at) {
    return blocks_at_.find(at.first, at.second) >= 0;
  };
  stray_scalars_.erase(std::remove_if(stray_scalars_.begin(), stray_scalars_.end(), has_block),
                       stray_scalars_.end());
  scalars_at_.take(n, stray_scalars_);
  scalars_.assign(static_cast<std::size_t>(scalars_at_.size()), 0.0);
  for (Places* strays : {&stray_blocks_, &stray_scalars_}) {
    strays->clear();
    strays->shrink_to_fit();
  }
}

double BlockMatrix::work() const {
  return 9.0 * blocks_at_.size() + 3.0 * scalars_at_.size() + shared_.work();
}

void BlockMatrix::multiply(const Eigen::Matrix3Xd& v, Eigen::Matrix3Xd& y) const {
  y.resize(3, v.cols());
  parallel_for(0, size(), kGrain, [&](int first, int last) {
    multiply_block_rows(first, last, blocks_at_.begins.data(), blocks_at_.columns.data(),
                        blocks_.front().data(), v.data(), y.data());
    if (scalars_.empty()) return;
    add_isotropic_rows(first, last, scalars_at_.begins.data(), scalars_at_.columns.data(),
                       scalars_.data(), v.data(), size(), y.data());
  });
  if (shared_.count() > 0) shared_.add_product(v, y);
}

}  // namespace pliant
