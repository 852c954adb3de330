#pragma once

#include <Eigen/Core>
#include <utility>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Triangles of a cloth with air below. Of each triangle's area, which presses on its corners, a
/// corner has the share that its mass has: else a pressure would lift vertices of one cloth by
/// different accelerations.
struct CoverTriangles {
  Eigen::Matrix3Xi corners;  ///< 3 x m vertex indices
  Eigen::Matrix3Xd shares;   ///< 3 x m, columns that sum to 1

  CoverTriangles() = default;
  CoverTriangles(Eigen::Matrix3Xi of, Eigen::Matrix3Xd by)
      : corners(std::move(of)), shares(std::move(by)) {}
  /// Those of the Voronoi cells at rest, as a cloth's masses are.
  explicit CoverTriangles(const TriangleMesh& rest)
      : corners(rest.triangles), shares(voronoi_shares(rest)) {}

  Eigen::Index size() const { return corners.cols(); }
};

}  // namespace pliant
