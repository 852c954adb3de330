#pragma once

#include <array>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A mesh's triangles and edges, and who is beside whom.
struct MeshSides {
  Edges edges;
  std::vector<std::array<int, 2>> triangles;  ///< of each edge; the second -1 at a boundary
  std::vector<std::array<int, 3>> opposite;   ///< of each triangle: edge opposite to corner k
};

/// Throws InputError as edges() does.
MeshSides find_sides(const TriangleMesh& mesh);

/// du/dn = Σ w_k u_k at the middle of an edge, n at right angles to it within the sheet, out of the
/// first of its triangles.
struct EdgeSlope {
  std::vector<int> vertices;
  std::vector<double> weights;  ///< [1/m]
};

/// From the values at the vertices around, as small corrections as will do to what the edge's own
/// triangles say: exact for every quadratic function on the sheet, which is unfolded about the edge
/// where it is not flat. Where the vertices within reach do not tell (a strip one triangle wide
/// does not know how it bends across) it is exact for what they do tell.
std::vector<EdgeSlope> edge_slopes(const TriangleMesh& mesh, const MeshSides& sides);

}  // namespace pliant
