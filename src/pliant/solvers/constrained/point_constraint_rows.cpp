#include "pliant/solvers/constrained/point_constraint_rows.h"

namespace pliant {

void PointConstraintRows::spread(const Eigen::VectorXd& mu, Forces& f) const {
  for (int r = 0; r < size(); ++r) {
    const Eigen::Vector3d force = mu[r] * direction(r);
    for (const auto* entry = begin(r); entry != end(r); ++entry) {
      f.col(entry->particle) += entry->weight * force;
    }
  }
}

void PointConstraintRows::gather(const Positions& e, Eigen::VectorXd& values) const {
  for (int r = 0; r < size(); ++r) {
    double sum = 0.0;
    for (const auto* entry = begin(r); entry != end(r); ++entry) {
      sum += entry->weight * direction(r).dot(e.col(entry->particle));
    }
    values[r] = sum;
  }
}

}  // namespace pliant
