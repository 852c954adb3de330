#include "pliant/geometry/mesh/tetrahedron_faces.h"

#include <algorithm>

namespace pliant {
namespace {
constexpr int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
}

Eigen::Vector3i face_vertices(const Eigen::Vector4i& tetrahedron, int face) {
  const auto& corners = kFaces[face];
  return {tetrahedron[corners[0]], tetrahedron[corners[1]], tetrahedron[corners[2]]};
}

std::vector<TetrahedronFace> sorted_faces(const Eigen::Matrix4Xi& tetrahedra) {
  std::vector<TetrahedronFace> faces;
  faces.reserve(static_cast<std::size_t>(4 * tetrahedra.cols()));
  for (int t = 0; t < tetrahedra.cols(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const Eigen::Vector3i v = face_vertices(tetrahedra.col(t), k);
      TetrahedronFace face{{v[0], v[1], v[2]}, t, k, false};
      face.even = ((v[0] < v[1]) + (v[1] < v[2]) + (v[2] < v[0])) == 2;
      std::sort(face.vertices.begin(), face.vertices.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end(), [](const TetrahedronFace& a, const TetrahedronFace& b) {
    return a.vertices != b.vertices ? a.vertices < b.vertices : a.tetrahedron < b.tetrahedron;
  });
  return faces;
}

std::size_t end_of_same_face(const std::vector<TetrahedronFace>& faces, std::size_t first) {
  std::size_t end = first + 1;
  while (end < faces.size() && faces[end].vertices == faces[first].vertices) ++end;
  return end;
}

}  // namespace pliant
