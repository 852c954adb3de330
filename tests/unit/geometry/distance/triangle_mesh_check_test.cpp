#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/mesh/grid.h"
#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TriangleMesh grid() {
  GridOptions options;
  options.columns = 4;
  options.rows = 4;
  return make_grid(options);
}

void expect_invalid(const TriangleMesh& mesh, std::vector<std::string> parts) {
  parts.push_back("a.obj: ");
  expect_refusal([&] { validate(mesh, "a.obj"); }, parts);
}

void flip(TriangleMesh& mesh, int triangle) {
  std::swap(mesh.triangles(0, triangle), mesh.triangles(1, triangle));
}

// A strip of n quads, its ends joined with a half turn.
TriangleMesh moebius_strip(int n) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * n);
  mesh.triangles.resize(3, 2 * n);
  for (int i = 0; i < n; ++i) {
    const double angle = 2.0 * M_PI * i / n;
    for (int side = 0; side < 2; ++side) {
      const double w = side - 0.5;
      const double r = 2.0 + w * std::cos(angle / 2.0);
      mesh.vertices.col(2 * i + side) << r * std::cos(angle), r * std::sin(angle),
          w * std::sin(angle / 2.0);
    }
    const int a = 2 * i, b = 2 * i + 1;
    const int c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;
    mesh.triangles.col(2 * i) << a, c, d;
    mesh.triangles.col(2 * i + 1) << a, d, b;
  }
  return mesh;
}

TEST(Validate, AcceptsGoodMeshesOfAnyScale) {
  for (const double scale : {1e-150, 1e-9, 1.0, 1e9, 1e150}) {
    TriangleMesh mesh = grid();
    mesh.vertices *= scale;
    EXPECT_NO_THROW(validate(mesh, "grid"));
  }
  EXPECT_NO_THROW(validate(Box(Vector3d(1e-3, 1.0, 1.0)).surface(), "box"));
}

TEST(Validate, RefusesEmptyMeshes) {
  TriangleMesh mesh;
  expect_invalid(mesh, {"no vertices"});
  mesh.vertices = Eigen::Matrix3Xd::Zero(3, 3);
  expect_invalid(mesh, {"no triangles"});
}

TEST(Validate, RefusesTooManyTriangles) {
  TriangleMesh mesh = grid();
  mesh.triangles.resize(3, kMaxTriangles + 1);
  expect_invalid(mesh, {"10000001 triangles", "at most 10000000"});
}

TEST(Validate, RefusesVerticesThatAreNotFinite) {
  TriangleMesh mesh = grid();
  mesh.vertices(1, 3) = std::nan("");
  mesh.vertices(0, 7) = -std::numeric_limits<double>::infinity();
  expect_invalid(mesh, {"2 vertices are not finite: 3, 7"});
  mesh.vertices.setConstant(std::nan(""));
  expect_invalid(mesh, {"16 vertices are not finite: 0, 1, 2, 3, 4, ..."});
}

TEST(Validate, RefusesIndicesOutOfRange) {
  for (const int index : {-1, 16, std::numeric_limits<int>::min()}) {
    TriangleMesh mesh = grid();
    mesh.triangles(2, 5) = index;
    expect_invalid(mesh, {"1 triangles name vertices outside [0, 15]: 5"});
  }
}

TEST(Validate, RefusesDegenerateTriangles) {
  TriangleMesh mesh = grid();
  mesh.triangles(1, 4) = mesh.triangles(0, 4);
  expect_invalid(mesh, {"1 triangles are degenerate", ": 4"});
  mesh = grid();
  mesh.vertices.row(0).setZero();
  expect_invalid(mesh, {"18 triangles are degenerate"});
}

TEST(Validate, RefusesRepeatedTriangles) {
  TriangleMesh mesh = grid();
  mesh.triangles.col(9) << mesh.triangles(1, 2), mesh.triangles(0, 2), mesh.triangles(2, 2);
  expect_invalid(mesh, {"1 triangles repeat another one: 9"});
}

TEST(Validate, RefusesUnusedVertices) {
  TriangleMesh mesh = grid();
  mesh.vertices.conservativeResize(3, 18);
  mesh.vertices.rightCols(2).setOnes();
  expect_invalid(mesh, {"2 vertices are in no triangle: 16, 17"});
}

TEST(Validate, RefusesMixedWinding) {
  TriangleMesh mesh = grid();
  flip(mesh, 17);
  expect_invalid(mesh, {"wind the other way", ": 17"});
}

TEST(OrientConsistently, LeavesGoodMeshesAlone) {
  TriangleMesh mesh = grid();
  EXPECT_TRUE(orient_consistently(mesh));
  EXPECT_EQ(mesh.triangles, grid().triangles);
}

TEST(OrientConsistently, FollowsTheMajority) {
  TriangleMesh mesh = grid();
  for (const int triangle : {0, 1, 6, 11, 17}) flip(mesh, triangle);
  EXPECT_TRUE(orient_consistently(mesh));
  EXPECT_NO_THROW(validate(mesh, "grid"));
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  for (int v = 0; v < normals.cols(); ++v) EXPECT_GT(normals(2, v), 0.99);
}

TEST(OrientConsistently, TreatsPartsSeparatelyAndKeepsTheFirstInADraw) {
  TriangleMesh mesh;
  mesh.vertices = Eigen::Matrix3Xd::Random(3, 8);
  mesh.triangles.resize(3, 4);
  mesh.triangles << 0, 1, 4, 5,  //
      1, 2, 5, 6,                //
      2, 3, 6, 7;                // both parts: the second triangle is opposed
  const Eigen::Matrix3Xi before = mesh.triangles;
  EXPECT_TRUE(orient_consistently(mesh));
  EXPECT_EQ(mesh.triangles.col(0), before.col(0));
  EXPECT_EQ(mesh.triangles.col(2), before.col(2));
  EXPECT_NE(mesh.triangles.col(1), before.col(1));
  EXPECT_NE(mesh.triangles.col(3), before.col(3));
  EXPECT_NO_THROW(validate(mesh, "parts"));
}

TEST(OrientConsistently, MendsEveryOtherTriangleOfABigMesh) {
  TriangleMesh mesh = Sphere(1.0).surface();
  for (int t = 0; t < mesh.triangles.cols(); t += 3) flip(mesh, t);
  EXPECT_TRUE(orient_consistently(mesh));
  EXPECT_NO_THROW(validate(mesh, "sphere"));
  EXPECT_GT(signed_volume(mesh), 4.0);
}

TEST(OrientConsistently, LeavesAMoebiusStripUnchanged) {
  TriangleMesh mesh = moebius_strip(12);
  const Eigen::Matrix3Xi before = mesh.triangles;
  EXPECT_FALSE(orient_consistently(mesh));
  EXPECT_EQ(mesh.triangles, before);
  expect_invalid(mesh, {"wind the other way"});
}

TEST(Validate, NamesEveryKindOfFaultAtOnce) {
  TriangleMesh mesh = Box(Vector3d::Ones()).surface();
  mesh.vertices.conservativeResize(3, 9);
  mesh.vertices.col(8) << 2.0, 2.0, 2.0;  // in no triangle
  mesh.triangles.conservativeResize(3, 15);
  mesh.triangles.col(12) = mesh.triangles.col(3);
  mesh.triangles.col(13) << 0, 1, 1;
  mesh.triangles.col(14) << mesh.triangles(0, 0), mesh.triangles(1, 0), 7;
  std::swap(mesh.triangles(0, 5), mesh.triangles(1, 5));
  expect_invalid(
      mesh, {"1 triangles are degenerate", "1 triangles repeat another one: 12",
             "1 vertices are in no triangle: 8", "at most 2 are allowed", "wind the other way"});
  EXPECT_EQ(mesh_faults(mesh).size(), 5u);
  EXPECT_TRUE(mesh_faults(Box(Vector3d::Ones()).surface()).empty());
}

}  // namespace
}  // namespace pliant
