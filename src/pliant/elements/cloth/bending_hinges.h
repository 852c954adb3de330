#pragma once

#include <array>
#include <vector>

#include "pliant/elements/cloth/bending_stencils.h"

namespace pliant {

/// What bends four vertices, E = 1/2 k |Σ w x|²: of a mesh the hinge of an inner edge, whose
/// vertices come first (Bergou et al. 2006, "A quadratic bending model for inextensible surfaces",
/// without their factor 3); of a grid a second difference along a row or column, with a vertex
/// beside it that has no weight, or the twist of a cell.
struct BendingHinge {
  std::array<int, 4> vertices;
  std::array<double, 4> weights;
  double stiffness = 0.0;  ///< [N/m]
};

/// One for each inner edge, of stiffness B_warp^c B_weft^(1 - c), c the squared cosine of the angle
/// between warp and the direction that it bends. So hinges that feel twist alone have
/// √(B_warp B_weft), as Huber 1923 has it for orthotropic plates. Nearly the plate's energy where
/// triangles are regular; where they are not it does not converge to it.
std::vector<BendingHinge> hinges_of_mesh(const TriangleMesh& rest, const Eigen::Vector3d& warp,
                                         const BendingStiffness& stiffness);

/// Second differences along the rows (warp) and columns (weft) of a grid at every inner vertex of
/// them, and the twist of each cell. `to_edges`: the half cells at the ends of a row bend as the
/// vertex next to them does, so that a sheet of constant curvature has the plate's energy, whatever
/// its size; else they do not bend.
std::vector<BendingHinge> hinges_of_grid(const GridOptions& grid, const BendingStiffness& stiffness,
                                         bool to_edges);

BendingStencils bending_of(const std::vector<BendingHinge>& hinges);

/// Of vertex `index` of `count` in a row: what it stands for across the row, in cells.
inline double share_across(int index, int count) {
  return index == 0 || index + 1 == count ? 0.5 : 1.0;
}

/// Of an inner vertex: what bends as it does along the row, in cells. The half cells at the ends
/// bend as the vertex next to them.
inline double share_along(int index, int count) {
  return 1.0 + (index == 1 ? 0.5 : 0.0) + (index + 2 == count ? 0.5 : 0.0);
}

}  // namespace pliant
