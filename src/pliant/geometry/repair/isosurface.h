#pragma once

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// The surface where the samples pass 0, by marching cubes: closed where no sample on the grid's
/// sides is negative, triangles turning outward. Empty where all have one sign.
TriangleMesh isosurface(const DistanceGrid& grid);

}  // namespace pliant
