#include "pliant/core/system/constraint.h"

namespace pliant {

void ConstraintRows::clear() {
  met_ = true;
  targets_.clear();
  compliances_.clear();
  begins_.assign(1, 0);
  entries_.clear();
}

void ConstraintRows::begin_row(double target, double compliance) {
  met_ = met_ && target == 0.0;
  targets_.push_back(target);
  compliances_.push_back(compliance);
  begins_.push_back(entries_.size());
}

void ConstraintRows::add(int particle, const Eigen::Vector3d& gradient) {
  entries_.push_back({particle, gradient});
  begins_.back() = entries_.size();
}

void ConstraintRows::renumber(std::size_t first, int by) {
  for (std::size_t k = first; k < entries_.size(); ++k) entries_[k].particle += by;
}

}  // namespace pliant
