#pragma once

#include <string>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A mesh of about `triangles` triangles, its vertices some of the given one's: edges are collapsed
/// in the order of the quadric error metric (Garland and Heckbert 1997, by OpenMesh), as long as
/// the surface keeps its topology and no triangle turns by more than 45 degrees in one collapse;
/// slivers only where nothing else is left. Where no further edge may go the result has more
/// triangles. A mesh that has no more than asked for is
/// returned as it is. Throws InputError, its message beginning with `where`, where triangles about
/// a vertex do not form one fan. The mesh must pass validate().
TriangleMesh simplify(const TriangleMesh& mesh, int triangles, const std::string& where = "mesh");

}  // namespace pliant
