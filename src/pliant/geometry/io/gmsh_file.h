#pragma once

#include "pliant/geometry/io/number_stream.h"
#include "pliant/geometry/io/numbered_mesh.h"

namespace pliant {

/// Reads a Gmsh file from its beginning; see read_tetrahedral_mesh().
TetrahedralMesh read_gmsh(NumberStream& stream);

}  // namespace pliant
