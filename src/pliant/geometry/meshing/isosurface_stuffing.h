#pragma once

#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Tetrahedra that fill where the samples are negative, over cubes of two spacings (Labelle and
/// Shewchuk 2007, section 3, uniform tetrahedra). Samples on the grid's outer three layers must be
/// positive. No tetrahedra where no lattice point is inside.
TetrahedralMesh stuff_negative(const DistanceGrid& grid);

}  // namespace pliant
