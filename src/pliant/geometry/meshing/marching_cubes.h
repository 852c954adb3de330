#pragma once

#include <array>
#include <vector>

namespace pliant {

/// Marching cubes (Lorensen and Cline 1987) whose table is derived instead of copied: on each face
/// of a cube inside corners are cut off one by one, by a rule that looks at that face alone, so
/// that neighbours agree and surfaces are closed whatever the values.
///
/// Corner c of a cube lies at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4 a + k runs along axis a from
/// the k-th corner that has no bit a.
struct MarchingCubes {
  using Triangle = std::array<int, 3>;  // edges, counter-clockwise seen from outside

  /// The lower corner of an edge.
  static int edge_corner(int edge);
  static int edge_axis(int edge) { return edge / 4; }
  /// Of the cube whose corner c is inside where bit c of `inside` is set.
  static const std::vector<Triangle>& triangles(int inside);
};

}  // namespace pliant
