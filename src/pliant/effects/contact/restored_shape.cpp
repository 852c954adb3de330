#include "pliant/effects/contact/restored_shape.h"

#include <algorithm>

namespace pliant {

void RestoredShape::begin_step() {
  has_bent_ = false;
  stuck_before_ = stuck_;
  by_before_ = by_;
}

void RestoredShape::note_bent(const Positions& x) {
  if (!has_bent_) stuck_.clear();
  has_bent_ = true;
  bent_ = x;
}

void RestoredShape::note_stuck(const Touching& touching) {
  if (stuck_.empty() || stuck_.back() != touching) stuck_.push_back(touching);
}

void RestoredShape::end_step(const Positions& x) {
  if (!has_bent_) {
    stuck_.clear();
    return;
  }
  has_bent_ = false;
  by_ = x - bent_;
  std::sort(stuck_.begin(), stuck_.end());
  stuck_.erase(std::unique(stuck_.begin(), stuck_.end()), stuck_.end());
}

bool RestoredShape::owes(const Touching& touching, const Eigen::Vector3d& by, double most) const {
  return std::binary_search(stuck_.begin(), stuck_.end(), touching) && by.norm() <= most;
}

void RestoredShape::undo_step() {
  stuck_ = stuck_before_;
  by_ = by_before_;
}

void RestoredShape::reset() { stuck_.clear(); }

void RestoredShape::save(StateArchive& numbers) const {
  numbers.write(static_cast<double>(stuck_.size()));
  for (const auto& [one, other] : stuck_) {
    numbers.write(one);
    numbers.write(other);
  }
  const Eigen::Index count = stuck_.empty() ? 0 : by_.cols();
  numbers.write(static_cast<double>(count));
  for (Eigen::Index i = 0; i < count; ++i) numbers.write_all(Eigen::Vector3d(by_.col(i)));
}

void RestoredShape::load(StateArchive& numbers) {
  stuck_.resize(numbers.read_count(2));
  for (auto& [one, other] : stuck_) {
    one = numbers.read_int();
    other = numbers.read_int();
  }
  // Of what was damaged nothing would be found.
  std::sort(stuck_.begin(), stuck_.end());
  by_.resize(3, static_cast<Eigen::Index>(numbers.read_count(3)));
  numbers.read_all(by_);
}

}  // namespace pliant
