#include "pliant/core/coupling.h"

namespace pliant {

void CouplingRows::clear() {
  met_ = true;
  targets_.clear();
  compliances_.clear();
  begins_.assign(1, 0);
  entries_.clear();
}

void CouplingRows::begin_row(double target, double compliance) {
  met_ = met_ && target == 0.0;
  targets_.push_back(target);
  compliances_.push_back(compliance);
  begins_.push_back(entries_.size());
}

void CouplingRows::add(int particle, const Eigen::Vector3d& gradient) {
  entries_.push_back({particle, gradient});
  begins_.back() = entries_.size();
}

void CouplingRows::renumber(std::size_t first, int by) {
  for (std::size_t k = first; k < entries_.size(); ++k) entries_[k].particle += by;
}

}  // namespace pliant
