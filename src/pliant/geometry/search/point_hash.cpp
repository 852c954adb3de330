#include "pliant/geometry/search/point_hash.h"

namespace pliant {

void PointHash::build(const Eigen::Matrix3Xd& points, double cell) {
  inverse_cell_ = 1.0 / cell;
  unsorted_.clear();
  for (int i = 0; i < points.cols(); ++i) {
    const Eigen::Array3d at = (points.col(i) * inverse_cell_).array().floor();
    // NaN fails the comparison too.
    if (!(at.abs().maxCoeff() <= kFarthest) || !at.allFinite()) continue;
    unsorted_.push_back({at.cast<int>(), i});
  }
  std::size_t buckets = 1;
  while (buckets < 2 * unsorted_.size()) buckets *= 2;
  mask_ = static_cast<std::uint32_t>(buckets - 1);
  least_.setOnes();
  largest_.setZero();
  begins_.assign(buckets + 1, 0);
  for (const Entry& entry : unsorted_) {
    const bool is_first = &entry == unsorted_.data();
    least_ = is_first ? entry.cell : least_.cwiseMin(entry.cell).eval();
    largest_ = is_first ? entry.cell : largest_.cwiseMax(entry.cell).eval();
    ++begins_[bucket(entry.cell) + 1];
  }
  for (std::size_t b = 0; b < buckets; ++b) begins_[b + 1] += begins_[b];
  entries_.resize(unsorted_.size());
  // From the back, each bucket's end moves to its beginning; points stay in order.
  for (std::size_t k = unsorted_.size(); k-- > 0;) {
    entries_[--begins_[bucket(unsorted_[k].cell) + 1]] = unsorted_[k];
  }
  // Now begins_[b + 1] is the beginning of bucket b.
  for (std::size_t b = 0; b < buckets; ++b) begins_[b] = begins_[b + 1];
  begins_[buckets] = entries_.size();
}

}  // namespace pliant
