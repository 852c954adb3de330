#include "pliant/geometry/mesh/tetrahedral_mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "pliant/geometry/mesh/tetrahedron_faces.h"

namespace pliant {

Eigen::VectorXd volumes(const TetrahedralMesh& mesh) {
  Eigen::VectorXd result(mesh.tetrahedra.cols());
  for (Eigen::Index t = 0; t < result.size(); ++t) {
    const Eigen::Vector4i v = mesh.tetrahedra.col(t);
    Eigen::Matrix3d sides;
    for (int k = 0; k < 3; ++k) {
      sides.col(k) = mesh.vertices.col(v[k + 1]) - mesh.vertices.col(v[0]);
    }
    result[t] = sides.determinant() / 6.0;
  }
  return result;
}

Eigen::VectorXd vertex_volumes(const TetrahedralMesh& mesh) {
  const Eigen::VectorXd each = volumes(mesh);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index t = 0; t < each.size(); ++t) {
    for (int k = 0; k < 4; ++k) result[mesh.tetrahedra(k, t)] += each[t] / 4.0;
  }
  return result;
}

Eigen::Matrix3Xi boundary_triangles(const TetrahedralMesh& mesh) {
  const std::vector<TetrahedronFace> faces = sorted_faces(mesh.tetrahedra);
  std::vector<TetrahedronFace> single;
  for (std::size_t first = 0; first < faces.size();) {
    const std::size_t end = end_of_same_face(faces, first);
    if (end - first == 1) single.push_back(faces[first]);
    first = end;
  }
  std::sort(single.begin(), single.end(), [](const TetrahedronFace& a, const TetrahedronFace& b) {
    return a.tetrahedron != b.tetrahedron ? a.tetrahedron < b.tetrahedron : a.face < b.face;
  });
  Eigen::Matrix3Xi result(3, static_cast<Eigen::Index>(single.size()));
  for (std::size_t f = 0; f < single.size(); ++f) {
    result.col(static_cast<Eigen::Index>(f)) =
        face_vertices(mesh.tetrahedra.col(single[f].tetrahedron), single[f].face);
  }
  return result;
}

int fix_winding(TetrahedralMesh& mesh) {
  const Eigen::VectorXd each = volumes(mesh);
  int inverted = 0;
  for (Eigen::Index t = 0; t < each.size(); ++t) {
    if (each[t] >= 0.0) continue;
    std::swap(mesh.tetrahedra(2, t), mesh.tetrahedra(3, t));
    ++inverted;
  }
  return inverted;
}

}  // namespace pliant
