#include "pliant/geometry/mesh/triangle_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TriangleMesh grid(int columns, int rows) {
  GridOptions options;
  options.width = 3.0;
  options.height = 2.0;
  options.columns = columns;
  options.rows = rows;
  return make_grid(options);
}

TriangleMesh box() { return Box(Vector3d(1.0, 2.0, 3.0)).surface(); }

TEST(TriangleMesh, AreaIsThatOfTheShape) {
  EXPECT_NEAR(area(grid(7, 5)), 6.0, 1e-12);
  EXPECT_NEAR(area(box()), 22.0, 1e-12);
  EXPECT_EQ(area(TriangleMesh()), 0.0);
}

TEST(TriangleMesh, VertexAreasSumToTheArea) {
  const Eigen::VectorXd areas = vertex_areas(grid(3, 3));
  EXPECT_NEAR(areas.sum(), 6.0, 1e-12);
  // All 8 triangles of 0.75 m^2 meet at the middle.
  EXPECT_NEAR(areas[4], 8 * 0.75 / 3.0, 1e-12);
}

TEST(TriangleMesh, VoronoiAreasOfAGridAreThoseOfItsCellsWhicheverWayItsDiagonalsLie) {
  const Eigen::VectorXd areas = voronoi_areas(grid(3, 3));
  EXPECT_NEAR(areas.sum(), 6.0, 1e-12);
  for (const int corner : {0, 2, 6, 8}) EXPECT_NEAR(areas[corner], 1.5 / 4.0, 1e-12);
  for (const int side : {1, 3, 5, 7}) EXPECT_NEAR(areas[side], 1.5 / 2.0, 1e-12);
  EXPECT_NEAR(areas[4], 1.5, 1e-12);
}

/// Shares of an acute triangle, counted on a fine lattice of points by the nearest vertex.
TEST(TriangleMesh, AVertexHasWhatIsNearestToIt) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0.0, 1.0, 0.3, 0.0, 0.1, 0.9, 0.0, 0.2, -0.1;
  mesh.triangles = Eigen::Vector3i(0, 1, 2);
  Vector3d counted = Vector3d::Zero();
  constexpr int kLines = 600;
  for (int i = 0; i < kLines; ++i) {
    for (int j = 0; i + j < kLines; ++j) {
      const double u = (i + 1.0 / 3.0) / kLines, v = (j + 1.0 / 3.0) / kLines;
      const Vector3d at = mesh.vertices * Vector3d(1.0 - u - v, u, v);
      int nearest = 0;
      (mesh.vertices.colwise() - at).colwise().squaredNorm().minCoeff(&nearest);
      counted[nearest] += 1.0;
    }
  }
  const Eigen::VectorXd areas = voronoi_areas(mesh);
  EXPECT_NEAR(areas.sum(), area(mesh), 1e-15);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(areas[k] / areas.sum(), counted[k] / counted.sum(), 3.0 / kLines) << k;
  }
}

TEST(TriangleMesh, AnObtuseTriangleIsSharedByHalvesAndQuartersWithoutAJumpAtTheRightAngle) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.triangles = Eigen::Vector3i(0, 1, 2);
  for (const double lean : {-1e-9, 0.0, 1e-9, -0.5}) {  // of the side at vertex 0
    mesh.vertices << 0.0, 1.0, lean, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0;
    const Eigen::VectorXd areas = voronoi_areas(mesh);
    EXPECT_NEAR(areas[0], 0.25, 1e-8) << lean;
    EXPECT_NEAR(areas[1], 0.125, 1e-8) << lean;
    EXPECT_NEAR(areas[2], 0.125, 1e-8) << lean;
  }
}

TEST(TriangleMesh, VoronoiAreasOfDegenerateTrianglesAreFinite) {
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Zero(3, 4);
  mesh.vertices(0, 1) = 1.0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 1, 3;
  EXPECT_EQ(voronoi_areas(mesh), Eigen::VectorXd::Zero(4));
}

TEST(TriangleMesh, NormalsOfASpherePointOutward) {
  const TriangleMesh sphere = Sphere(0.5).surface();
  const Eigen::Matrix3Xd normals = vertex_normals(sphere);
  for (int v = 0; v < normals.cols(); ++v) {
    EXPECT_NEAR(normals.col(v).norm(), 1.0, 1e-12);
    EXPECT_GT(normals.col(v).dot(sphere.vertices.col(v)), 0.499);
  }
}

TEST(TriangleMesh, NormalsAreDefinedWhereTrianglesVanishOrCancel) {
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Zero(3, 5);
  mesh.vertices.col(3) << 1e-160, 0.0, 0.0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0, 1, 2, 3, 3;
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  for (int v = 0; v < 5; ++v) EXPECT_EQ(normals.col(v), Vector3d::UnitZ());
}

TEST(TriangleMesh, NormalsOfTinyTrianglesAreUnit) {
  TriangleMesh mesh = grid(2, 2);
  mesh.vertices *= 1e-155;
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  for (int v = 0; v < 4; ++v) EXPECT_EQ(normals.col(v), Vector3d::UnitZ());
}

TEST(TriangleMesh, SignedVolumeTellsTheWinding) {
  TriangleMesh mesh = box();
  mesh.vertices.colwise() += Vector3d(1e4, -1e4, 0.0);
  EXPECT_NEAR(signed_volume(mesh), 6.0, 1e-9);
  mesh.triangles.row(0).swap(mesh.triangles.row(1));
  EXPECT_NEAR(signed_volume(mesh), -6.0, 1e-9);
  EXPECT_EQ(signed_volume(TriangleMesh()), 0.0);
}

TEST(Edges, AreSortedAndKnowBothTriangles) {
  const Edges all = edges(grid(2, 2));
  const std::vector<std::array<int, 2>> vertices = {{0, 1}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  const std::vector<std::array<int, 2>> opposite = {{3, -1}, {3, -1}, {1, 2}, {0, -1}, {0, -1}};
  EXPECT_EQ(all.vertices, vertices);
  EXPECT_EQ(all.opposite, opposite);
}

TEST(Edges, FulfilEulersFormula) {
  const TriangleMesh mesh = box();
  EXPECT_EQ(edges(mesh).vertices.size(), mesh.vertices.cols() + mesh.triangles.cols() - 2u);
  EXPECT_TRUE(edges(TriangleMesh()).vertices.empty());
}

TEST(Edges, RefuseThreeTrianglesAtAnEdge) {
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Random(3, 5);
  mesh.triangles.resize(3, 3);
  mesh.triangles << 1, 1, 4, 4, 4, 1, 0, 2, 3;
  expect_refusal([&] { edges(mesh); }, {"vertices 1 and 4", "3 triangles"});
  expect_refusal([&] { boundary_vertices(mesh); }, {"vertices 1 and 4"});
  expect_refusal([&] { orient_consistently(mesh); }, {"vertices 1 and 4"});
  expect_refusal([&] { validate(mesh, "cap.obj"); }, {"cap.obj: ", "vertices 1 and 4"});
}

TEST(BoundaryVertices, AreTheRimOfAGridAndNoneOfABox) {
  EXPECT_EQ(boundary_vertices(grid(3, 3)), (std::vector<int>{0, 1, 2, 3, 5, 6, 7, 8}));
  EXPECT_TRUE(boundary_vertices(box()).empty());
}

}  // namespace
}  // namespace pliant
