#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// What clean_mesh() did.
struct MeshCleaning {
  int joined = 0;      ///< vertices of open edges that another one is as good as at
  int degenerate = 0;  ///< triangles without area that were dropped
  int repeated = 0;    ///< triangles that were there before, dropped
};

/// The mesh with vertices at the same place joined (those of open edges also where they lie within
/// a hundred-thousandth of its longest side), and without triangles that have no area or that
/// repeat another one, however they turn, and without vertices of none. Triangles without area stay
/// where without them the mesh would be less closed. Indices must be in range and vertices finite.
TriangleMesh clean_mesh(const TriangleMesh& mesh, MeshCleaning& done);

/// Edges that have `least` to `most` triangles.
int count_edges(const TriangleMesh& mesh, int least, int most);

/// Edges whose two triangles run along it in the same direction, so that they wind against each
/// other.
int count_opposed(const TriangleMesh& mesh);

}  // namespace pliant
