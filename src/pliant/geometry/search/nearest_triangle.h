#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/search/box_tree.h"

namespace pliant {

/// Finds the triangle of a mesh that is nearest to a point, in about the logarithm of their number.
class NearestTriangle {
 public:
  struct Result {
    int triangle = -1;      ///< -1 where none is nearer than the limit
    Eigen::Vector3d point;  ///< on it [m]
    double distance = std::numeric_limits<double>::infinity();  ///< to it [m]
  };

  /// The mesh must have triangles and only finite vertices; it is copied.
  explicit NearestTriangle(TriangleMesh mesh);

  /// The nearest triangle; of equally near ones always the same. Safe to call from many threads.
  Result operator()(const Eigen::Vector3d& p) const { return near(p, -1); }
  /// The same distance, found sooner where the triangle `hint` is nearly the nearest; -1: none.
  Result near(const Eigen::Vector3d& p, int hint) const;
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  BoxTree tree_;
};

}  // namespace pliant
