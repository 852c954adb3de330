#ifndef PLIANT_GEOMETRY_GRID_H_
#define PLIANT_GEOMETRY_GRID_H_

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

struct GridOptions {
  double width = 1.0;   // [m], along x (warp); positive and finite
  double height = 1.0;  // [m], along y (weft); positive and finite
  int columns = 2;      // vertices along x; at least 2
  int rows = 2;         // vertices along y; at least 2
};

// A flat rectangle in the xy plane, centred at the origin. Vertex row * columns + column lies at
// column along x and row along y; triangles are counter-clockwise seen from +z; the diagonals of
// neighbouring cells alternate. Throws InputError, naming the field and its range, for options
// outside their range or more than kMaxTriangles triangles.
TriangleMesh make_grid(const GridOptions& options);

}  // namespace pliant

#endif  // PLIANT_GEOMETRY_GRID_H_
