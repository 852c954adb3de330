#include "pliant/models/viscoelastic/nearby_particles.h"

#include <cstring>
#include <limits>

#include "pliant/math/widest.h"

namespace pliant {
namespace {

// The same order of sums for any width of registers.
constexpr int kLanes = 16;
using Lanes __attribute__((vector_size(kLanes * sizeof(float)))) = float;

/// x, y, z and w of particles, whole Lanes of them; what fills them up has no weight.
struct Columns {
  const float *x, *y, *z, *weight;
  int count;
};

/// Σ w (1 − s r²)³ about `point`, and where `offsets` is not null that sum times (x − point).
PLIANT_WIDEST float sum_kernels(const Columns& columns, const float* point, float sharpness,
                                float* offsets) {
  Lanes sum = {}, along[3] = {};
  for (int k = 0; k < columns.count; k += kLanes) {
    Lanes x, y, z, weight;
    std::memcpy(&x, columns.x + k, sizeof x);
    std::memcpy(&y, columns.y + k, sizeof y);
    std::memcpy(&z, columns.z + k, sizeof z);
    std::memcpy(&weight, columns.weight + k, sizeof weight);
    x -= point[0];
    y -= point[1];
    z -= point[2];
    Lanes left = 1.0f - sharpness * (x * x + y * y + z * z);
    left = left > 0.0f ? left : Lanes{};
    const Lanes kernel = weight * (left * left * left);
    sum += kernel;
    if (offsets == nullptr) continue;
    along[0] += kernel * x;
    along[1] += kernel * y;
    along[2] += kernel * z;
  }
  float total = 0.0f;
  for (int l = 0; l < kLanes; ++l) total += sum[l];
  for (int axis = 0; offsets != nullptr && axis < 3; ++axis) {
    offsets[axis] = 0.0f;
    for (int l = 0; l < kLanes; ++l) offsets[axis] += along[axis][l];
  }
  return total;
}

}  // namespace

void NearbyParticles::gather(const NeighborLists& lists, const Eigen::VectorXf& weights,
                             const NeighborLists::Cell& cell) {
  lists_ = &lists;
  rows_ = lists.rows_about(cell, hints_);
  count_ = 0;
  for (const auto& row : rows_) count_ += row[1] - row[0];
  const int filled = (count_ + kLanes - 1) / kLanes * kLanes;
  if (filled > weight_.size()) {
    for (Array* values : {&x_, &y_, &z_, &weight_, &kernel_}) values->setZero(2 * filled);
  }
  weight_.segment(count_, filled - count_).setZero();
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

float NearbyParticles::sum(const Eigen::Vector3f& point) const {
  const int filled = (count_ + kLanes - 1) / kLanes * kLanes;
  return sum_kernels({x_.data(), y_.data(), z_.data(), weight_.data(), filled}, point.data(),
                     sharpness_, nullptr);
}

float NearbyParticles::sum(const Eigen::Vector3f& point, Eigen::Vector3f& offsets) const {
  const int filled = (count_ + kLanes - 1) / kLanes * kLanes;
  return sum_kernels({x_.data(), y_.data(), z_.data(), weight_.data(), filled}, point.data(),
                     sharpness_, offsets.data());
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
