#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// The directions in which a surface looks about points of it: those between the normals of the
/// faces that come together there. What touches the surface near such a point touches it along one
/// of them.
class NormalCones {
 public:
  NormalCones() = default;
  /// Of `points` on a closed surface, 3 x n [m].
  NormalCones(const TriangleMesh& surface, const Eigen::Matrix3Xd& points);

  bool is_empty() const { return reach_.size() == 0; }
  /// How far about the point these are all faces [m]; 0 where the surface is not convex there.
  double reach(int point) const { return reach_[point]; }
  /// The part of `direction` that is in a point's cone: of a way from the point to a place outside
  /// it is the shortest way there from the faces about the point.
  Eigen::Vector3d part_within(int point, const Eigen::Vector3d& direction) const;

 private:
  std::vector<int> begins_;   // of each point's normals, and the end of the last
  Eigen::Matrix3Xd normals_;  // of unit length
  Eigen::VectorXd reach_;
};

}  // namespace pliant
