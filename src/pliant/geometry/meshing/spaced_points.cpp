#include "pliant/geometry/meshing/spaced_points.h"

namespace pliant {

std::size_t SpacedPoints::Hash::operator()(const Cell& cell) const {
  std::uint64_t hash = 0;
  for (const std::int64_t c : cell) {
    hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ull;
    hash ^= hash >> 32;
  }
  return static_cast<std::size_t>(hash);
}

SpacedPoints::Cell SpacedPoints::cell_of(const Eigen::Vector3d& p) const {
  return (p / least_).array().floor().cast<std::int64_t>();
}

bool SpacedPoints::keep(const Eigen::Vector3d& p) {
  const Cell middle = cell_of(p);
  for (int code = 0; code < 27; ++code) {
    const Cell cell = middle + Cell(code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1);
    const auto found = kept_.find(cell);
    if (found == kept_.end()) continue;
    for (const Eigen::Vector3d& other : found->second) {
      if ((p - other).squaredNorm() < least_ * least_) return false;
    }
  }
  force(p);
  return true;
}

void SpacedPoints::force(const Eigen::Vector3d& p) { kept_[cell_of(p)].push_back(p); }

}  // namespace pliant
