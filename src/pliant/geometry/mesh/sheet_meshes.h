#pragma once

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// A tube along z about the origin, open at both ends, as a sleeve is.
struct TubeOptions {
  double radius = 0.1;  ///< [m]
  double length = 0.3;  ///< [m]
  int around = 24;      ///< cells around, >= 3
  int along = 12;       ///< cells along, >= 1
};
/// Vertex row * around + k lies at height row and angle k; normals point outwards, the diagonals of
/// neighbouring cells alternate as far as an odd number around lets them. Throws InputError for
/// options out of their range or more than kMaxTriangles triangles.
TriangleMesh make_tube(const TubeOptions& options);

/// A flat rectangle in the xy plane with a round hole about the origin.
struct HoledSheetOptions {
  double width = 0.5;   ///< along x [m]
  double height = 0.5;  ///< along y [m]
  double hole = 0.1;    ///< radius, less than half of the shorter side [m]
  int side = 12;        ///< cells along each side, >= 1
  int rings = 8;        ///< cells from the hole to the sides, >= 1
};
/// Rings of 4 side vertices, from the hole to the sides. Throws InputError as make_tube().
TriangleMesh make_holed_sheet(const HoledSheetOptions& options);

}  // namespace pliant
