#include "pliant/models/viscoelastic/nearby_particles.h"

#include <limits>

namespace pliant {

void NearbyParticles::gather(const NeighborLists& lists, const Eigen::VectorXf& weights,
                             const NeighborLists::Cell& cell) {
  lists_ = &lists;
  rows_ = lists.rows_about(cell, hints_);
  count_ = 0;
  for (const auto& row : rows_) count_ += row[1] - row[0];
  if (count_ > weight_.size()) {
    for (Array* values : {&x_, &y_, &z_, &weight_, &kernel_}) values->resize(2 * count_);
  }
  const double scale = 1.0 / lists.radius();
  int k = 0;
  for (const auto& row : rows_) {
    const int count = row[1] - row[0];
    Array* const coordinates[] = {&x_, &y_, &z_};
    for (int axis = 0; axis < 3; ++axis) {
      const double corner = lists.origin()[axis] + lists.radius() * cell[axis];
      const Eigen::Map<const Eigen::ArrayXd> own(lists.along(axis).data() + row[0], count);
      coordinates[axis]->segment(k, count) = (scale * (own - corner)).cast<float>();
    }
    weight_.segment(k, count) = weights.segment(row[0], count);
    k += count;
  }
}

void NearbyParticles::weigh(const Eigen::Vector3f& point) {
  const auto square = (x_.head(count_) - point[0]).square() +
                      (y_.head(count_) - point[1]).square() + (z_.head(count_) - point[2]).square();
  const auto left = (1.0f - sharpness_ * square).max(0.0f);
  kernel_.head(count_) = weight_.head(count_) * left.cube();
}

float NearbyParticles::sum(const Eigen::Vector3f& point) {
  weigh(point);
  return kernel_.head(count_).sum();
}

float NearbyParticles::sum(const Eigen::Vector3f& point, Eigen::Vector3f& offsets) {
  weigh(point);
  const auto kernel = kernel_.head(count_);
  const float sum = kernel.sum();
  offsets = Eigen::Vector3f((kernel * x_.head(count_)).sum(), (kernel * y_.head(count_)).sum(),
                            (kernel * z_.head(count_)).sum()) -
            sum * point;
  return sum;
}

Eigen::VectorXd NearbyParticles::mean(const Eigen::Vector3f& point, const Eigen::MatrixXd& values) {
  weigh(point);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(values.rows());
  double sum = std::numeric_limits<double>::min();
  int k = 0;
  for (const auto& row : rows_) {
    for (int rank = row[0]; rank < row[1]; ++rank, ++k) {
      if (kernel_[k] == 0.0f) continue;
      const auto weight = static_cast<double>(kernel_[k]);
      result += weight * values.col(lists_->order()[static_cast<std::size_t>(rank)]);
      sum += weight;
    }
  }
  return result / sum;
}

}  // namespace pliant
