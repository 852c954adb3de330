#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace pliant {

struct TetrahedronFace {
  std::array<int, 3> vertices;  ///< ascending
  int tetrahedron;
  int face;   ///< 0 to 3
  bool even;  ///< its outward winding is an even permutation of `vertices`
};

/// Vertices of a face of a tetrahedron with positive volume, counter-clockwise seen from outside.
Eigen::Vector3i face_vertices(const Eigen::Vector4i& tetrahedron, int face);

/// All faces, those with the same vertices together.
std::vector<TetrahedronFace> sorted_faces(const Eigen::Matrix4Xi& tetrahedra);

/// The first place after `first` whose face has other vertices.
std::size_t end_of_same_face(const std::vector<TetrahedronFace>& faces, std::size_t first);

}  // namespace pliant
