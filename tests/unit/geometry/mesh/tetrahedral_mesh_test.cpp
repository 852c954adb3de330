#include "pliant/geometry/mesh/tetrahedral_mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/expect_refusal.h"
#include "support/random.h"

namespace pliant {
namespace {

/// Two tetrahedra with a common face.
TetrahedralMesh pair() {
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 0, 0, 1,  //
      0, 0, 1, 0, 1,               //
      0, 0, 0, 1, 1;
  mesh.tetrahedra.resize(4, 2);
  mesh.tetrahedra.col(0) << 0, 1, 2, 3;
  mesh.tetrahedra.col(1) << 1, 2, 3, 4;
  return mesh;
}

void expect_refused(const TetrahedralMesh& mesh, const std::vector<std::string>& parts) {
  std::vector<std::string> all = parts;
  all.push_back("body.mesh: ");
  expect_refusal([&] { validate(mesh, "body.mesh"); }, all);
}

TEST(TetrahedralMesh, VolumesAndTheirShares) {
  const TetrahedralMesh mesh = pair();
  const Eigen::VectorXd each = volumes(mesh);
  EXPECT_NEAR(each[0], 1.0 / 6.0, 1e-16);
  EXPECT_NEAR(each[1], 1.0 / 3.0, 1e-16);
  const Eigen::VectorXd shares = vertex_volumes(mesh);
  EXPECT_NEAR(shares[0], each[0] / 4.0, 1e-16);
  EXPECT_NEAR(shares[1], each.sum() / 4.0, 1e-16);
  EXPECT_NEAR(shares.sum(), each.sum(), 1e-15);
}

TEST(TetrahedralMesh, BoundaryLooksOutward) {
  const TetrahedralMesh mesh = pair();
  const Eigen::Matrix3Xi triangles = boundary_triangles(mesh);
  EXPECT_EQ(triangles.cols(), 6);
  const Eigen::Vector3d middle = mesh.vertices.rowwise().mean();
  for (const auto t : triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]), b = mesh.vertices.col(t[1]),
                          c = mesh.vertices.col(t[2]);
    EXPECT_GT((b - a).cross(c - a).dot(a - middle), 0.0);
  }
}

TEST(TetrahedralMesh, GoodMeshesPassAtAnyScaleAndPlace) {
  for (const double scale : {1e-100, 1e-6, 1.0, 1e6, 1e100}) {
    TetrahedralMesh mesh = pair();
    mesh.vertices *= scale;
    EXPECT_NO_THROW(validate(mesh, "test")) << scale;
  }
  TetrahedralMesh mesh = make_block({{0.1, 0.1, 0.1}, {3, 3, 3}});
  mesh.vertices.colwise() += Eigen::Vector3d(1000.0, -1000.0, 1000.0);
  EXPECT_NO_THROW(validate(mesh, "test"));
}

TEST(TetrahedralMesh, RefusesEmptyMeshes) {
  TetrahedralMesh mesh;
  mesh.vertices.resize(3, 0);
  mesh.tetrahedra.resize(4, 0);
  expect_refused(mesh, {"no vertices"});
  mesh.vertices = pair().vertices;
  expect_refused(mesh, {"no tetrahedra"});
}

TEST(TetrahedralMesh, RefusesBadNumbers) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    TetrahedralMesh mesh = pair();
    mesh.vertices(1, 3) = bad;
    expect_refused(mesh, {"1 vertices are not finite: 3"});
  }
  for (const int bad : {-1, 5, std::numeric_limits<int>::max()}) {
    TetrahedralMesh mesh = pair();
    mesh.tetrahedra(2, 1) = bad;
    expect_refused(mesh, {"vertices outside [0, 4]: 1"});
  }
}

TEST(TetrahedralMesh, RefusesFlatTetrahedra) {
  TetrahedralMesh mesh = pair();
  mesh.vertices.col(4) << 0.5, 0.5, 1e-12;
  mesh.tetrahedra.col(1) << 0, 1, 2, 4;
  expect_refused(mesh, {"1 tetrahedra are flat", "remove", ": 1"});
  mesh = pair();
  mesh.tetrahedra(3, 1) = 3;  // a vertex twice
  expect_refused(mesh, {"flat", ": 1"});
  mesh = pair();
  mesh.vertices.setZero();
  expect_refused(mesh, {"2 tetrahedra are flat", ": 0, 1"});
}

TEST(TetrahedralMesh, RefusesInvertedTetrahedraAndMendsTheirWinding) {
  TetrahedralMesh mesh = make_block({{1, 1, 1}, {2, 2, 2}});
  EXPECT_EQ(fix_winding(mesh), 0);
  const Eigen::VectorXd before = volumes(mesh);
  for (int t : {3, 17, 20}) std::swap(mesh.tetrahedra(0, t), mesh.tetrahedra(1, t));
  expect_refused(mesh, {"3 tetrahedra are inverted", "fix_winding", ": 3, 17, 20"});
  EXPECT_EQ(fix_winding(mesh), 3);
  EXPECT_NO_THROW(validate(mesh, "test"));
  EXPECT_LE((volumes(mesh) - before).norm(), 1e-15);
}

TEST(TetrahedralMesh, WindingIsNotMendedWhereTheMeshFoldsOverItself) {
  TetrahedralMesh mesh = pair();
  mesh.vertices.col(4) << 0.1, 0.1, 0.1;  // through the common face
  expect_refused(mesh, {"inverted", ": 1"});
  EXPECT_EQ(fix_winding(mesh), 1);
  expect_refused(mesh, {"overlap a neighbour", "folds over itself", ": 1"});
}

TEST(TetrahedralMesh, OfTwoThatOverlapTheLaterIsNamed) {
  TetrahedralMesh mesh = pair();
  mesh.vertices.col(4) << 0.1, 0.1, 0.1;
  std::swap(mesh.tetrahedra(0, 1), mesh.tetrahedra(1, 1));
  expect_refused(mesh, {"1 tetrahedra overlap a neighbour", "folds over itself there: 1"});
}

TEST(TetrahedralMesh, RefusesRepeatedTetrahedra) {
  TetrahedralMesh mesh = pair();
  mesh.tetrahedra.conservativeResize(4, 3);
  mesh.tetrahedra.col(2) << 2, 3, 1, 4;  // another order, the same one
  expect_refused(mesh, {"1 tetrahedra repeat another one", ": 2"});
}

TEST(TetrahedralMesh, RefusesVerticesWithoutTetrahedron) {
  TetrahedralMesh mesh = pair();
  mesh.vertices.conservativeResize(3, 7);
  mesh.vertices.rightCols(2) = Eigen::Matrix<double, 3, 2>::Random();
  expect_refused(mesh, {"2 vertices are in no tetrahedron", ": 5, 6"});
}

TEST(TetrahedralMesh, RefusesThreeTetrahedraOnAFace) {
  TetrahedralMesh mesh = pair();
  mesh.vertices.conservativeResize(3, 6);
  mesh.vertices.col(5) << 2, 2, 2;
  mesh.tetrahedra.conservativeResize(4, 3);
  mesh.tetrahedra.col(2) << 1, 2, 3, 5;
  expect_refused(mesh, {"share a face with two others", ": 2"});
}

}  // namespace
}  // namespace pliant
