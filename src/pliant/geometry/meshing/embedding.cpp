#include "pliant/geometry/meshing/embedding.h"

#include <Eigen/LU>
#include <vector>

#include "pliant/geometry/mesh/offenders.h"
#include "pliant/geometry/mesh/tetrahedron_faces.h"
#include "pliant/geometry/search/box_tree.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

Vector4d barycentric(const TetrahedralMesh& mesh, int tetrahedron, const Vector3d& p) {
  const auto v = mesh.tetrahedra.col(tetrahedron);
  Eigen::Matrix3d sides;
  for (int k = 0; k < 3; ++k) {
    sides.col(k) = mesh.vertices.col(v[k + 1]) - mesh.vertices.col(v[0]);
  }
  const Vector3d rest = sides.inverse() * (p - mesh.vertices.col(v[0]));
  return {1.0 - rest.sum(), rest[0], rest[1], rest[2]};
}

BoxTree tree_over(const TetrahedralMesh& mesh) {
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto t : mesh.tetrahedra.colwise()) {
    Eigen::AlignedBox3d box(Vector3d(mesh.vertices.col(t[0])));
    for (int k = 1; k < 4; ++k) box.extend(mesh.vertices.col(t[k]));
    boxes.push_back(box);
  }
  return make_box_tree(boxes);
}

/// What Eigen's BVIntersect asks for: the first tetrahedron that contains p.
struct Containing {
  const TetrahedralMesh& mesh;
  const Vector3d& p;
  int first = -1;

  bool intersectVolume(const Eigen::AlignedBox3d& box) const { return box.contains(p); }
  bool intersectObject(int tetrahedron) {
    if (first >= 0 && tetrahedron >= first) return false;
    if (barycentric(mesh, tetrahedron, p).minCoeff() >= 0.0) first = tetrahedron;
    return false;  // go on: the first is the one with the least index
  }
};

/// The boundary's triangles and the tetrahedron behind each.
struct Boundary {
  TriangleMesh surface;
  std::vector<int> behind;
};

Boundary boundary_of(const TetrahedralMesh& mesh) {
  Boundary result;
  std::vector<Eigen::Vector3i> triangles;
  const std::vector<TetrahedronFace> faces = sorted_faces(mesh.tetrahedra);
  for (std::size_t first = 0; first < faces.size();) {
    const std::size_t end = end_of_same_face(faces, first);
    if (end == first + 1) {
      const TetrahedronFace& face = faces[first];
      triangles.push_back(face_vertices(mesh.tetrahedra.col(face.tetrahedron), face.face));
      result.behind.push_back(face.tetrahedron);
    }
    first = end;
  }
  result.surface.vertices = mesh.vertices;
  result.surface.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    result.surface.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return result;
}

void check_points(const Eigen::Matrix3Xd& points, const std::string& where) {
  Offenders not_finite;
  for (int i = 0; i < points.cols(); ++i) {
    if (!points.col(i).allFinite()) not_finite.add(i);
  }
  not_finite.refuse(where, "points are not finite");
}

}  // namespace

Embedding embed(const Eigen::Matrix3Xd& points, const TetrahedralMesh& mesh,
                const std::string& where) {
  check_points(points, where);
  const BoxTree tree = tree_over(mesh);
  const Boundary boundary = boundary_of(mesh);
  const NearestTriangle nearest(boundary.surface);
  Embedding result;
  result.tetrahedron.resize(points.cols());
  result.weights.resize(4, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vector3d p = points.col(i);
    Containing containing{mesh, p};
    Eigen::BVIntersect(tree, containing);
    int& tetrahedron = result.tetrahedron[i];
    tetrahedron = containing.first;
    if (tetrahedron < 0) {
      tetrahedron = boundary.behind[static_cast<std::size_t>(nearest(p).triangle)];
    }
    result.weights.col(i) = barycentric(mesh, tetrahedron, p);
  }
  return result;
}

void carry(const Embedding& embedding, const Eigen::Matrix4Xi& tetrahedra,
           const Eigen::Matrix3Xd& vertices, Eigen::Ref<Eigen::Matrix3Xd> points) {
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int* v = tetrahedra.col(embedding.tetrahedron[i]).data();
    const double* w = embedding.weights.col(i).data();
    points.col(i) = w[0] * vertices.col(v[0]) + w[1] * vertices.col(v[1]) +
                    w[2] * vertices.col(v[2]) + w[3] * vertices.col(v[3]);
  }
}

Eigen::Matrix3Xd embedded_positions(const Embedding& embedding, const Eigen::Matrix4Xi& tetrahedra,
                                    const Eigen::Matrix3Xd& vertices) {
  Eigen::Matrix3Xd result(3, embedding.tetrahedron.size());
  carry(embedding, tetrahedra, vertices, result);
  return result;
}

}  // namespace pliant
