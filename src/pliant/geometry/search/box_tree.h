#pragma once

#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A tree over indexed boxes for searches by Eigen's BVH.
using BoxTree = Eigen::KdBVH<double, 3, int>;

inline BoxTree make_box_tree(const std::vector<Eigen::AlignedBox3d>& boxes) {
  std::vector<int> indices(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) indices[i] = static_cast<int>(i);
  return {indices.begin(), indices.end(), boxes.begin(), boxes.end()};
}

/// Over a mesh's triangles; it must have only finite vertices.
inline BoxTree make_box_tree(const TriangleMesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto t : mesh.triangles.colwise()) {
    Eigen::AlignedBox3d box(Eigen::Vector3d(mesh.vertices.col(t[0])));
    box.extend(mesh.vertices.col(t[1])).extend(mesh.vertices.col(t[2]));
    boxes.push_back(box);
  }
  return make_box_tree(boxes);
}

}  // namespace pliant
