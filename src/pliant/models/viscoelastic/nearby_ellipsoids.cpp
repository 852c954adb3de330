#include "pliant/models/viscoelastic/nearby_ellipsoids.h"

namespace pliant {

void KernelEllipsoids::resize(int count) {
  m.setZero(6, count);
  weights.setZero(count);
}

void KernelEllipsoids::set(int rank, const Eigen::Matrix3f& axes, const Eigen::Vector3f& extents) {
  const Eigen::Matrix3f full =
      axes * extents.cwiseAbs2().cwiseInverse().asDiagonal() * axes.transpose();
  m.col(rank) << full(0, 0), full(1, 1), full(2, 2), full(0, 1), full(1, 2), full(2, 0);
}

void NearbyEllipsoids::gather(const NeighborLists& lists, const KernelEllipsoids& kernels,
                              const NeighborLists::Cell& cell) {
  const NeighborLists::Rows rows = lists.rows_about(cell, hints_);
  count_ = 0;
  for (const auto& row : rows) count_ += row[1] - row[0];
  if (count_ > columns_.rows()) columns_.resize(2 * count_, 10);
  const double scale = 1.0 / lists.radius();
  int k = 0;
  for (const auto& row : rows) {
    const int first = row[0], count = row[1] - row[0];
    for (int axis = 0; axis < 3; ++axis) {
      const double corner = lists.origin()[axis] + lists.radius() * cell[axis];
      const Eigen::Map<const Eigen::ArrayXd> own(lists.along(axis).data() + first, count);
      columns_.col(axis).segment(k, count) = (scale * (own - corner)).cast<float>();
    }
    for (int c = 0; c < 6; ++c) {
      columns_.col(3 + c).segment(k, count) =
          (c < 3 ? 1.0f : 2.0f) * kernels.m.row(c).segment(first, count).transpose().array();
    }
    columns_.col(9).segment(k, count) = kernels.weights.segment(first, count);
    k += count;
  }
}

float NearbyEllipsoids::sum(const Eigen::Vector3f& point) {
  const auto column = [this](int c) { return columns_.col(c).head(count_); };
  const auto x = column(0) - point[0], y = column(1) - point[1], z = column(2) - point[2];
  const auto square = x * (column(3) * x + column(6) * y + column(8) * z) +
                      y * (column(4) * y + column(7) * z) + column(5) * z.square();
  return (column(9) * (1.0f - square).max(0.0f).cube()).sum();
}

}  // namespace pliant
