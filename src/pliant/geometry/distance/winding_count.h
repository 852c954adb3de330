#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/search/box_hierarchy.h"

namespace pliant {

/// How often closed surfaces wind around points: by what a ray upwards passes, in about the
/// logarithm of the number of triangles. Exact but for points that are on a surface to round-off.
class WindingCount {
 public:
  /// A closed mesh of finite vertices; it is copied.
  explicit WindingCount(TriangleMesh mesh);

  /// 1 within a closed surface whose triangles turn outward, 0 outside. Safe to call from many
  /// threads.
  int operator()(const Eigen::Vector3d& p) const;

  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  BoxHierarchy tree_;
  double top_ = 0.0;  // of the mesh [m]
};

}  // namespace pliant
