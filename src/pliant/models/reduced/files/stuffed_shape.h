#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A solid given by a function: negative inside, near its surface about the signed distance [m].
struct FunctionShape {
  std::function<double(const Eigen::Vector3d&)> distance;
  Eigen::AlignedBox3d bounds;  ///< around the solid
};

/// Tetrahedra that fill a solid and the smooth surface that they carry.
struct StuffedShape {
  TetrahedralMesh mesh;
  TriangleMesh surface;  ///< finer than the tetrahedra
};

/// Isosurface stuffing (isosurface_stuffing.h) with cubes of `cell_size`, and the isosurface of
/// samples `surface_spacing` apart [m]. Throws InputError, beginning with `name`, where no sample
/// is inside.
StuffedShape stuff_shape(const FunctionShape& shape, double cell_size, double surface_spacing,
                         const std::string& name);

}  // namespace pliant
