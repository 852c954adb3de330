#pragma once

#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Two triangles that share an edge, and whether both run along it in the same direction.
struct TriangleNeighbours {
  int triangles[2];
  bool opposed;
};

/// Those over edges that have two triangles, in the edges' order.
std::vector<TriangleNeighbours> triangle_neighbours(const TriangleMesh& mesh);

/// Union-find of triangles that also knows whether a member is flipped relative to its root.
class OrientationUnion {
 public:
  explicit OrientationUnion(int count);

  int root(int member);
  bool flipped(int member);
  /// Says that a and b are opposed or not; false when that contradicts what was said before. The
  /// smaller triangle stays the root.
  bool relate(int a, int b, bool opposed);

 private:
  std::vector<int> parent_;
  std::vector<char> flipped_;  // relative to the parent
};

/// Flips the triangles of each set until its members agree; the winding of the majority wins, the
/// root's where there is a draw.
void orient_by_majority(OrientationUnion& sets, TriangleMesh& mesh);

}  // namespace pliant
