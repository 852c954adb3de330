#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/carried_points.h"
#include "pliant/geometry/nearest_triangle.h"
#include "pliant/geometry/tetrahedral_mesh.h"

namespace pliant {

/// A triangle of a surface that moves with the four particles of a tetrahedron.
struct CarriedTriangle {
  Eigen::Vector4i particles;
  Eigen::Matrix<double, 4, 3> weights;  ///< barycentric coordinates of its corners, a column each
  int part = 0;

  Eigen::Matrix3d corners(const Positions& x) const {
    Eigen::Matrix3d corners = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 4; ++k) corners += x.col(particles[k]) * weights.row(k);
    return corners;
  }
};

/// A body as what may touch itself sees it at rest: its parts, which no tetrahedron joins, the
/// triangles of their surfaces, and the points that are kept out of them.
class SelfContactParts {
 public:
  /// `triangles` index `surface`; without a surface they are the boundary of the tetrahedra, and
  /// without contact points these are the boundary's vertices. Throws InputError for a mesh that
  /// validate() refuses.
  SelfContactParts(const TetrahedralMesh& rest, const Eigen::Matrix3Xi& triangles,
                   const CarriedPoints* surface, const CarriedPoints* contact);

  const TetrahedralMesh& rest() const { return rest_; }
  const CarriedPoints& points() const { return points_; }
  const Eigen::Matrix3Xd& rest_points() const { return rest_points_; }
  const std::vector<CarriedTriangle>& triangles() const { return triangles_; }  ///< part by part
  const std::vector<double>& longest_edges() const { return longest_edges_; }   ///< per tetrahedron
  int part_of_particle(int particle) const {
    return particle_parts_[static_cast<std::size_t>(particle)];
  }
  int part_of_point(int point) const { return part_of_particle(points_.particles()(0, point)); }
  /// How far the surfaces stand out of the tetrahedra [m].
  double bulge() const { return bulge_; }
  /// The triangle of a part's surface that is nearest to `at`, a place in the rest frame.
  NearestTriangle::Result nearest(int part, const Eigen::Vector3d& at) const;

 private:
  void find_parts();
  void take_boundary();
  void take_surface(const Eigen::Matrix3Xi& triangles, const CarriedPoints& surface);
  void take_boundary_points();
  void sort_triangles();

  TetrahedralMesh rest_;
  std::vector<int> particle_parts_;
  std::vector<CarriedTriangle> triangles_;
  std::vector<int> first_triangles_;      // per part
  std::vector<NearestTriangle> nearest_;  // per part
  std::vector<double> longest_edges_;
  CarriedPoints points_;
  Eigen::Matrix3Xd rest_points_;
  double bulge_ = 0.0;
};

}  // namespace pliant
