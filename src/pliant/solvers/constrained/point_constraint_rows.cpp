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

template <class ColumnOf, class Columns>
void PointConstraintRows::spread_to(const Eigen::VectorXd& mu, const ColumnOf& column_of,
                                    Columns& f) const {
  for_constraints([&](int row, auto rows) {
    Eigen::Vector3d forces[rows];
    for (int k = 0; k < rows; ++k) forces[k] = mu[row + k] * direction(row + k);
    for (const auto* entry = begin(row); entry != end(row); ++entry) {
      const int column = column_of(entry->particle);
      if (column < 0) continue;
      Eigen::Vector3d sum = f.col(column).template head<3>();
      for (int k = 0; k < rows; ++k) sum += entry->weight * forces[k];
      f.col(column).template head<3>() = sum;
    }
  });
}

template <class ColumnOf, class Columns>
void PointConstraintRows::gather_from(const Columns& e, const ColumnOf& column_of,
                                      Eigen::VectorXd& values) const {
  for_constraints([&](int row, auto rows) {
    double sums[rows] = {};
    for (const auto* entry = begin(row); entry != end(row); ++entry) {
      const int column = column_of(entry->particle);
      if (column < 0) continue;
      const Eigen::Vector3d displacement = e.col(column).template head<3>();
      for (int k = 0; k < rows; ++k) {
        sums[k] += entry->weight * direction(row + k).dot(displacement);
      }
    }
    for (int k = 0; k < rows; ++k) values[row + k] = sums[k];
  });
}

void PointConstraintRows::spread(const Eigen::VectorXd& mu, Forces& f) const {
  spread_to(
      mu, [](int particle) { return particle; }, f);
}

void PointConstraintRows::gather(const Positions& e, Eigen::VectorXd& values) const {
  gather_from(
      e, [](int particle) { return particle; }, values);
}

void PointConstraintRows::spread(const Eigen::VectorXd& mu, const std::vector<int>& column_of,
                                 Eigen::Matrix4Xd& f) const {
  spread_to(
      mu, [&](int particle) { return column_of[static_cast<std::size_t>(particle)]; }, f);
}

void PointConstraintRows::gather(const Eigen::Matrix4Xd& e, const std::vector<int>& column_of,
                                 Eigen::VectorXd& values) const {
  gather_from(
      e, [&](int particle) { return column_of[static_cast<std::size_t>(particle)]; }, values);
}

}  // namespace pliant
