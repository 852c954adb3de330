#pragma once

#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// How far a surface stands out of tetrahedra: the largest distance of a place on it from them [m],
/// 0 where they hold all of it. Never too small, and too large by at most `tolerance` [m], but for
/// triangles more than a hundred times as long, of which only their 4096th parts are looked at.
/// Throws InputError, its message beginning with `where`, for vertices that are not finite.
double outreach(const TriangleMesh& surface, const TetrahedralMesh& mesh, double tolerance,
                const std::string& where);

}  // namespace pliant
