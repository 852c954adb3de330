#pragma once

#include <array>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Distances of many points from a mesh, several neighbours at a time in the lanes of the
/// processor's vector registers.
class MeshDistances {
 public:
  static constexpr int kLanes = 8;
  using Lanes = std::array<double, kLanes>;
  /// Coordinates of points that lie near each other [m].
  struct Points {
    Lanes x, y, z;
  };

  /// The mesh must have only finite vertices.
  explicit MeshDistances(const TriangleMesh& mesh);

  /// Lowers `distances` to those of the points from the mesh where these are less [m]. `hint` is a
  /// triangle that is near the points, or -1; then one that was found. Safe to call from many
  /// threads.
  void lower(const Points& points, Lanes& distances, int& hint) const;

  /// A triangle with what each of its distances needs.
  struct Face {
    double corners[3][3];    // [m]
    double sides[3][3];      // from each corner to the next [m]
    double lengths[3];       // of the sides, squared [m²]
    double normal[3], area;  // product of two sides, and its square [m⁴]
  };
  /// Two boxes and what is in them.
  struct Node {
    double low[2][3], high[2][3];  // [m]
    int inside[2];                 // a node, or ~ a face, or kNothing
  };
  static constexpr int kNothing = 0x7fffffff;

 private:
  int add_node(const std::vector<std::array<double, 6>>& boxes, int* begin, int* end);

  std::vector<Face> faces_;
  std::vector<Node> nodes_;  // the first one holds all
};

}  // namespace pliant
