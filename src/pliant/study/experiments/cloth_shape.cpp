#include "pliant/study/experiments/cloth_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

constexpr int kSamples = 180;
constexpr double kLevel = 0.02;      // of the mean height
constexpr double kProminence = 0.2;  // of what heights differ by

/// Height of a triangle over `at`; negative beside it.
double height_in(const Eigen::Matrix3d& corners, const Eigen::Vector2d& at) {
  Eigen::Matrix2d sides;
  sides << corners.col(1).head<2>() - corners.col(0).head<2>(),
      corners.col(2).head<2>() - corners.col(0).head<2>();
  const double area = sides.determinant();
  if (area == 0.0) return -1.0;
  const Eigen::Vector2d w = sides.inverse() * (at - corners.col(0).head<2>());
  if (w.minCoeff() < 0.0 || w.sum() > 1.0) return -1.0;
  return (1.0 - w.sum()) * corners(2, 0) + w[0] * corners(2, 1) + w[1] * corners(2, 2);
}

/// How far one has to go down from k to come to anything higher.
double prominence(const std::vector<double>& heights, int k) {
  const int n = static_cast<int>(heights.size());
  const double own = heights[static_cast<std::size_t>(k)];
  double least = INFINITY;
  for (const int direction : {1, -1}) {
    double lowest = own;
    for (int s = 1; s < n; ++s) {
      const double other = heights[static_cast<std::size_t>(((k + direction * s) % n + n) % n)];
      if (other > own || (other == own && direction < 0)) break;
      lowest = std::min(lowest, other);
    }
    least = std::min(least, own - lowest);
  }
  return least;
}

}  // namespace

double height_at(const GridOptions& grid, const Positions& x, const Eigen::Vector2d& at) {
  double highest = 0.0;
  for (int r = 0; r + 1 < grid.rows; ++r) {
    for (int c = 0; c + 1 < grid.columns; ++c) {
      const int i = r * grid.columns + c, up = i + grid.columns;
      Eigen::Matrix3d one, other;
      one << x.col(i), x.col(i + 1), x.col(up + 1);
      other << x.col(i), x.col(up + 1), x.col(up);
      highest = std::max({highest, height_in(one, at), height_in(other, at)});
    }
  }
  return highest;
}

Folds find_folds(const GridOptions& grid, const Positions& x, const Eigen::Vector2d& center,
                 double radius) {
  Folds folds;
  double sum = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double angle = 2.0 * M_PI * k / kSamples;
    const Eigen::Vector2d at = center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    folds.heights.push_back(height_at(grid, x, at));
    sum += folds.heights.back();
  }
  const auto [low, high] = std::minmax_element(folds.heights.begin(), folds.heights.end());
  const double range = *high - *low;
  if (!(range > kLevel * sum / kSamples)) return folds;
  for (int k = 0; k < kSamples; ++k) {
    if (prominence(folds.heights, k) < kProminence * range) continue;
    folds.directions.push_back(360.0 * k / kSamples);
  }
  return folds;
}

double wetted_radius(const Eigen::VectorXd& areas, const Positions& x, double above) {
  double lifted = 0.0;
  for (int i = 0; i < areas.size(); ++i) lifted += x(2, i) > above ? areas[i] : 0.0;
  return std::sqrt(lifted / M_PI);
}

}  // namespace pliant
