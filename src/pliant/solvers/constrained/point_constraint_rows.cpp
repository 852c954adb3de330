#include "pliant/solvers/constrained/point_constraint_rows.h"

#include <type_traits>

namespace pliant {

template <class Body>
void PointConstraintRows::for_constraints(const Body& body) const {
  for (int row = 0; row < size();) {
    int end = row + 1;
    while (end < size() && end < row + 3 && constraint(end) == constraint(row)) ++end;
    if (end - row == 3) {
      body(row, std::integral_constant<int, 3>());
    } else if (end - row == 2) {
      body(row, std::integral_constant<int, 2>());
    } else {
      body(row, std::integral_constant<int, 1>());
    }
    row = end;
  }
}

void PointConstraintRows::spread(const Eigen::VectorXd& mu, Forces& f) const {
  for_constraints([&](int row, auto rows) {
    Eigen::Vector3d forces[rows];
    for (int k = 0; k < rows; ++k) forces[k] = mu[row + k] * direction(row + k);
    for (const auto* entry = begin(row); entry != end(row); ++entry) {
      Eigen::Vector3d sum = f.col(entry->particle);
      for (int k = 0; k < rows; ++k) sum += entry->weight * forces[k];
      f.col(entry->particle) = sum;
    }
  });
}

void PointConstraintRows::gather(const Positions& e, Eigen::VectorXd& values) const {
  for_constraints([&](int row, auto rows) {
    double sums[rows] = {};
    for (const auto* entry = begin(row); entry != end(row); ++entry) {
      const Eigen::Vector3d displacement = e.col(entry->particle);
      for (int k = 0; k < rows; ++k) {
        sums[k] += entry->weight * direction(row + k).dot(displacement);
      }
    }
    for (int k = 0; k < rows; ++k) values[row + k] = sums[k];
  });
}

}  // namespace pliant
