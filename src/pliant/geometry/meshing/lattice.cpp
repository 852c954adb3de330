#include "pliant/geometry/meshing/lattice.h"

namespace pliant {

Lattice::Lattice(const DistanceGrid& grid)
    : grid_(&grid), stride_{1, grid.count[0], grid.count[0] * grid.count[1]} {
  std::size_t n = 0;
  for (int code = 0; code < kShortNeighbours; ++code) {
    steps_[n] = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      steps_[n] += (code >> axis & 1) != 0 ? stride_[axis] : -stride_[axis];
    }
    ++n;
  }
  for (const int stride : stride_) {
    steps_[n++] = -2 * stride;
    steps_[n++] = 2 * stride;
  }
}

Eigen::Array3i Lattice::coordinates(int point) const {
  return {point % stride_[1], point % stride_[2] / stride_[1], point / stride_[2]};
}

std::vector<int> Lattice::inner_points() const {
  std::vector<int> result;
  const Eigen::Array3i last = grid_->count - 2;
  for (int z = 2; z < last[2]; ++z) {
    const int first = 2 + z % 2;
    for (int y = first; y < last[1]; y += 2) {
      for (int x = first; x < last[0]; x += 2) {
        result.push_back(x + y * stride_[1] + z * stride_[2]);
      }
    }
  }
  return result;
}

}  // namespace pliant
