#pragma once

#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// How a rectangle is cut into triangles: diagonals of cells that alternate, that all lean one way,
/// that lean at random, and the latter between vertices that are off their places by up to a
/// quarter of a cell (those at a side along it alone, those of corners not at all).
enum class Triangulation { kAlternating, kOneSided, kRandomDiagonals, kIrregular };

constexpr Triangulation kTriangulations[] = {Triangulation::kAlternating, Triangulation::kOneSided,
                                             Triangulation::kRandomDiagonals,
                                             Triangulation::kIrregular};

const char* name_of(Triangulation mesh);

/// Vertices are numbered as make_grid() does. The first `regular_columns` columns of vertices stay
/// in their places along x, for a clamp to hold.
TriangleMesh triangulated(const GridOptions& grid, Triangulation mesh, int regular_columns = 1);

}  // namespace pliant
