#pragma once

#include "pliant/geometry/io/number_stream.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Reads a pair of TetGen files from their beginnings; see read_tetrahedral_mesh().
TetrahedralMesh read_tetgen(NumberStream& node_file, NumberStream& ele_file);

}  // namespace pliant
