#ifndef PLIANT_GEOMETRY_MESH_SHAPE_H_
#define PLIANT_GEOMETRY_MESH_SHAPE_H_

#include <Eigen/Core>
#include <string>

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/distance/shape.h"

namespace pliant {

struct MeshShapeOptions {
  // Spacing of the distance samples [m]; parts thinner than about two of them are lost. 0: 1/64 of
  // the mesh's longest side. Refused above that side, or when it asks for more than 30 million
  // samples (four bytes each).
  double voxel_size = 0.0;
};

// A grid without samples around `bounds`, with 4 voxels to spare on each side. Throws InputError
// for a voxel_size that is refused.
DistanceGrid lay_grid(const Eigen::AlignedBox3d& bounds, double voxel_size);

// Whether any sample is negative.
bool has_inside(const DistanceGrid& grid);

// The solid inside a closed mesh, as samples of its signed distance on a dense grid (made once with
// OpenVDB), interpolated trilinearly. Errors in distance are of the order of voxel_size^2 times
// curvature on smooth parts and below voxel_size at edges. Beyond the grid (4 voxels around the
// mesh) distances are a lower bound of the true one.
class MeshShape final : public Shape {
 public:
  // Reorients a mesh whose winding is mixed or inward. Throws InputError as validate() does, for an
  // open mesh (with the number of boundary edges), for options out of range, and for a mesh that is
  // too thin for the voxel size.
  explicit MeshShape(TriangleMesh mesh, const MeshShapeOptions& options = {});

  // Of samples that are there, such as of lay_grid(); `surface` is what is drawn, and encloses the
  // solid. The grid has samples, two or more along each axis.
  MeshShape(TriangleMesh surface, DistanceGrid grid);

  SurfacePoint query(const Eigen::Vector3d& p) const override;
  Eigen::AlignedBox3d bounds() const override { return bounds_; }
  TriangleMesh surface() const override { return mesh_; }
  AnyShape as_any() const override { return this; }
  std::string name() const override { return "mesh"; }
  bool convex() const override { return false; }
  double voxel_size() const { return grid_.spacing; }  // [m]
  const DistanceGrid& grid() const { return grid_; }

 private:
  struct Cell {
    const float* corner;       // sample at the lowest corner
    Eigen::Vector3d fraction;  // position within the cell, 0..1
    Eigen::Vector3d beyond;    // from the nearest point of the grid to p [m]; 0 within
  };
  Cell find_cell(const Eigen::Vector3d& p) const;
  SurfacePoint interpolate(const Cell& cell) const;  // the normal not of unit length

  TriangleMesh mesh_;
  Eigen::AlignedBox3d bounds_;
  DistanceGrid grid_;
};

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_MESH_SHAPE_H_
