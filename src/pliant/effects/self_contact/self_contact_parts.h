#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/body/embedded_points.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {

/// A triangle of a surface. Neighbours share their corners, so that the surface stays closed
/// however it is deformed; forces on the triangle go to the particles of one tetrahedron.
struct EmbeddedTriangle {
  Eigen::Vector3i vertices;  ///< of the surface
  Eigen::Vector4i particles = Eigen::Vector4i::Zero();
  /// Barycentric coordinates of its corners at rest, a column each.
  Eigen::Matrix<double, 4, 3> weights = Eigen::Matrix<double, 4, 3>::Zero();
  int part = 0;

  /// A column each, where the surface's vertices are at `surface` [m].
  Eigen::Matrix3d corners(const Eigen::Matrix3Xd& surface) const {
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.col(c) = surface.col(vertices[c]);
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
                   const EmbeddedPoints* surface, const EmbeddedPoints* contact);

  const TetrahedralMesh& rest() const { return rest_; }
  /// The vertices of the triangles.
  const EmbeddedPoints& surface() const { return surface_; }
  const Eigen::Matrix3Xd& rest_surface() const { return rest_surface_; }
  const EmbeddedPoints& points() const { return points_; }
  const Eigen::Matrix3Xd& rest_points() const { return rest_points_; }
  const std::vector<EmbeddedTriangle>& triangles() const { return triangles_; }  ///< part by part
  int count() const { return static_cast<int>(first_triangles_.size()); }        ///< of parts
  const std::vector<double>& longest_edges() const { return longest_edges_; }  ///< per tetrahedron
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
  void take_surface(const Eigen::Matrix3Xi& triangles);
  void take_boundary_points();
  void sort_triangles();

  TetrahedralMesh rest_;
  std::vector<int> particle_parts_;
  std::vector<EmbeddedTriangle> triangles_;
  std::vector<int> first_triangles_;      // per part
  std::vector<NearestTriangle> nearest_;  // per part
  std::vector<double> longest_edges_;
  EmbeddedPoints surface_, points_;
  Eigen::Matrix3Xd rest_surface_;
  Eigen::Matrix3Xd rest_points_;
  double bulge_ = 0.0;
};

}  // namespace pliant
