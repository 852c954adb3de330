#pragma once

#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

struct StuffingOptions {
  /// Edge length of the lattice's cubes [m]: twelve tetrahedra fill one. 0: found from
  /// `tetrahedra`. Parts of the solid thinner than about one of them are lost.
  double cell_size = 0.0;
  /// About how many tetrahedra to make, within 5 % where the solid allows; used only where
  /// cell_size is 0. In [1, kMaxTetrahedra].
  int tetrahedra = 10'000;
  /// Holes of the surface up to this width (largest extent of their rim) [m] are closed by a fan
  /// of triangles before the distance is taken; wider ones are refused. Negative: one cell.
  double hole_size = -1.0;
};

/// Dihedral angles of every tetrahedron that stuff() makes lie within these bounds [degrees],
/// whatever the surface: proven by branch and bound over all stencils and all places of their
/// corners (stuffing_bounds_test.cpp), and met within 0.1 degrees. Smooth surfaces stay well
/// within.
constexpr double kStuffingLeastAngle = 8.7;
constexpr double kStuffingGreatestAngle = 160.6;

/// Tetrahedra that fill the solid within a closed surface: signed distance on a grid (OpenVDB
/// decides what is inside, so that the surface may intersect itself or consist of overlapping
/// parts), then isosurface stuffing (Labelle and Shewchuk, "Isosurface stuffing: fast tetrahedral
/// meshes with good dihedral angles", SIGGRAPH 2007). Vertices of the result's boundary lie on the
/// surface up to the square of the cell size times curvature; edges and corners of the surface are
/// rounded by about half a cell. The same surface and options give the same bits.
///
/// Throws InputError, its message beginning with `where` (a file or scene field), when
/// - validate() refuses the surface: no vertices, no triangles, not finite, an edge with more than
///   two triangles, neighbours that wind the other way;
/// - it is open: a hole is wider than hole_size; or inside out: it encloses a negative volume;
/// - an option is outside its range, or asks for more than 30 million distance samples;
/// - there is no interior: the solid is too thin for the cells.
TetrahedralMesh stuff(const TriangleMesh& surface, const StuffingOptions& options,
                      const std::string& where = "surface");

}  // namespace pliant
