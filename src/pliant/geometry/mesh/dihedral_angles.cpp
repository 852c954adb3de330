#include "pliant/geometry/mesh/dihedral_angles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "pliant/geometry/mesh/tetrahedron_faces.h"

namespace pliant {

AngleRange dihedral_angles(const TetrahedralMesh& mesh) {
  constexpr double kDegrees = 180.0 / 3.14159265358979323846;
  AngleRange range{180.0, 0.0};
  for (const auto tetrahedron : mesh.tetrahedra.colwise()) {
    std::array<Eigen::Vector3d, 4> normals;  // outward
    for (int face = 0; face < 4; ++face) {
      const Eigen::Vector3i v = face_vertices(tetrahedron, face);
      const Eigen::Vector3d a = mesh.vertices.col(v[0]);
      normals[static_cast<std::size_t>(face)] =
          (mesh.vertices.col(v[1]) - a).cross(mesh.vertices.col(v[2]) - a);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double turn =
            std::atan2(normals[i].cross(normals[j]).norm(), normals[i].dot(normals[j]));
        const double angle = 180.0 - kDegrees * turn;
        range.least = std::min(range.least, angle);
        range.greatest = std::max(range.greatest, angle);
      }
    }
  }
  return range;
}

}  // namespace pliant
