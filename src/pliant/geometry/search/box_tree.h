#pragma once

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>
#include <vector>

namespace pliant {

/// A tree over indexed boxes for searches by Eigen's BVH.
using BoxTree = Eigen::KdBVH<double, 3, int>;

inline BoxTree make_box_tree(const std::vector<Eigen::AlignedBox3d>& boxes) {
  std::vector<int> indices(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) indices[i] = static_cast<int>(i);
  return {indices.begin(), indices.end(), boxes.begin(), boxes.end()};
}

}  // namespace pliant
