#pragma once

#include <array>
#include <vector>

#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// Pieces of a sheet, and the curvature of each, κ_r = Σ_k w_rk x_k (vectors, since each coordinate
/// bends): E = 1/2 Σ |κ_r|², where the roots of stiffness and area are in the weights.
struct BendingStencils {
  int rows = 1;                   ///< components r of each piece
  std::vector<int> firsts = {0};  ///< piece e has the vertices from firsts[e] to firsts[e + 1]
  std::vector<int> vertices;
  std::vector<double> weights;  ///< `rows` numbers a vertex, which add up to nothing over a piece

  std::vector<std::array<int, 3>> triangles;  ///< of each piece; of a grid none

  int size() const { return static_cast<int>(firsts.size()) - 1; }
};

/// Bending stiffness, moment per width and curvature, of what bends along warp and along weft, both
/// > 0 [N m]. A sheet of those stores the orthotropic plate's
///   E = 1/2 ∫ B_warp κ_x² + B_weft κ_y² + 2 √(B_warp B_weft) κ_xy²,
/// its twist by the mean that Huber 1923 has for such plates.
struct BendingStiffness {
  double warp = 0.0;
  double weft = 0.0;
};

/// Of any mesh, a piece a triangle: Morley's plate element, whose curvature is constant within a
/// triangle and follows from the slopes across the middles of its edges,
///   A κ = Σ_e l_e n_e ⊗ ∇u(e),
/// with slopes from the vertices about an edge (edge_slopes.h) in place of unknowns of their own.
/// Both triangles at an edge have the same slope there, so constant curvature is in equilibrium,
/// and slopes are exact for quadratics, so it is met: sheets of any triangulation converge to the
/// plate, at least of first order. The flat state of the unfolded mesh is the one without energy.
/// The warp of a triangle is the part of `warp` in its plane.
BendingStencils bending_of_mesh(const TriangleMesh& rest, const Eigen::Vector3d& warp,
                                const BendingStiffness& stiffness);

}  // namespace pliant
