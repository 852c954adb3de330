#include "pliant/solvers/constrained/point_constraint_rows.h"

namespace pliant {

int PointConstraintRows::end_of_constraint(int row) const {
  int end = row + 1;
  while (end < size() && end < row + kMostTogether && constraint(end) == constraint(row)) ++end;
  return end;
}

template <int kRows>
void PointConstraintRows::spread_rows(int row, const Eigen::VectorXd& mu, Forces& f) const {
  Eigen::Vector3d force[kRows];
  for (int k = 0; k < kRows; ++k) force[k] = mu[row + k] * direction(row + k);
  for (const auto* entry = begin(row); entry != end(row); ++entry) {
    Eigen::Vector3d sum = f.col(entry->particle);
    for (int k = 0; k < kRows; ++k) sum += entry->weight * force[k];
    f.col(entry->particle) = sum;
  }
}

template <int kRows>
void PointConstraintRows::gather_rows(int row, const Positions& e, Eigen::VectorXd& values) const {
  double sums[kRows] = {};
  for (const auto* entry = begin(row); entry != end(row); ++entry) {
    const Eigen::Vector3d displacement = e.col(entry->particle);
    for (int k = 0; k < kRows; ++k) {
      sums[k] += entry->weight * direction(row + k).dot(displacement);
    }
  }
  for (int k = 0; k < kRows; ++k) values[row + k] = sums[k];
}

void PointConstraintRows::spread(const Eigen::VectorXd& mu, Forces& f) const {
  for (int row = 0; row < size();) {
    const int end = end_of_constraint(row);
    if (end - row == 3) {
      spread_rows<3>(row, mu, f);
    } else if (end - row == 2) {
      spread_rows<2>(row, mu, f);
    } else {
      spread_rows<1>(row, mu, f);
    }
    row = end;
  }
}

void PointConstraintRows::gather(const Positions& e, Eigen::VectorXd& values) const {
  for (int row = 0; row < size();) {
    const int end = end_of_constraint(row);
    if (end - row == 3) {
      gather_rows<3>(row, e, values);
    } else if (end - row == 2) {
      gather_rows<2>(row, e, values);
    } else {
      gather_rows<1>(row, e, values);
    }
    row = end;
  }
}

}  // namespace pliant
