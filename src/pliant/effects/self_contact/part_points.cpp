#include "pliant/effects/self_contact/part_points.h"

#include <algorithm>
#include <cmath>

namespace pliant {

void PartPoints::build(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& motions,
                       double cell) {
  const auto count = static_cast<Eigen::Index>(numbers_.size());
  points_.resize(3, count);
  bounds_.setEmpty();
  mean_motion_.setZero();
  for (Eigen::Index k = 0; k < count; ++k) {
    const int number = numbers_[static_cast<std::size_t>(k)];
    points_.col(k) = points.col(number);
    if (points_.col(k).allFinite()) bounds_.extend(points_.col(k));
    mean_motion_ += motions.col(number) / static_cast<double>(count);
  }
  double squared = 0.0;
  for (const int number : numbers_) {
    squared = std::max(squared, (motions.col(number) - mean_motion_).squaredNorm());
  }
  spread_ = std::sqrt(squared);
  hash_.build(points_, cell);
}

}  // namespace pliant
