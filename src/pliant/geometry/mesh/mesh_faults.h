#pragma once

#include <string>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Whether a height of the triangle is below 1e-10 of its longest edge.
bool is_degenerate(const TriangleMesh& mesh, int triangle);

/// All that validate() refuses, a phrase each, of each kind the first offenders and how many there
/// are; empty for a mesh that it accepts.
std::vector<std::string> mesh_faults(const TriangleMesh& mesh);

}  // namespace pliant
