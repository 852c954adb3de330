#include "pliant/solvers/iterations/best_iterate.h"

namespace pliant {

void BestIterate::offer(double left, double residual, const Positions& x,
                        const PointConstraints& constraints) {
  if (!(left < left_)) return;
  left_ = left;
  residual_ = residual;
  x_ = x;
  constraints_ = constraints.all;
}

void BestIterate::restore(Positions& x, PointConstraints& constraints) const {
  x = x_;
  for (std::size_t c = 0; c < constraints_.size(); ++c) {
    constraints.all[c].normal_force = constraints_[c].normal_force;
    constraints.all[c].friction_force = constraints_[c].friction_force;
  }
}

}  // namespace pliant
