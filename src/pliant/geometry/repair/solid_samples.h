#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// What sample_solid() found out about a surface.
struct SolidSamples {
  bool has_inside = false;  ///< whether any sample is within
  double closed = 0.0;      ///< share of the solid's surface that closes holes: no triangle is near
  double loose = 0.0;       ///< share of the triangles' area that has outside on both sides

  /// Whether the surface says enough to be taken for a solid's: at most a quarter of the solid's
  /// surface closes holes, and at most a tenth of the mesh is loose.
  bool is_plausible() const;
  /// What `closed` and `loose` are, in words, a phrase each; none for a share below 0.05 %.
  std::vector<std::string> phrases() const;
};

constexpr double kFarthestSample = 1e30;  ///< [m], of no surface at all

/// Fills grid.samples with the signed distances to the solid that a surface bounds though it has
/// holes and cracks, and though parts of it pass through each other: what its generalized winding
/// number is above one half of, and what no path from outside leads to. Walls within the solid and
/// sheets outside of it are left out of the distance; where holes are closed it is off by up to a
/// spacing. The mesh should turn outward and lie within the grid. Distances above `farthest` [m],
/// two spacings or more, become that, which is sooner found. The same bits for any number of
/// threads.
SolidSamples sample_solid(const TriangleMesh& mesh, DistanceGrid& grid,
                          double farthest = kFarthestSample);

/// Fills grid.samples with the signed distances to all points within half of `thickness` [m] of a
/// mesh of finite vertices, however it is made. The same bits for any number of threads.
void sample_shell(const TriangleMesh& mesh, double thickness, DistanceGrid& grid);

}  // namespace pliant
