#include "pliant/geometry/mesh/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

GridOptions options(double width, double height, int columns, int rows) {
  GridOptions result;
  result.width = width;
  result.height = height;
  result.columns = columns;
  result.rows = rows;
  return result;
}

TEST(MakeGrid, OrdersVerticesByRowThenColumn) {
  const TriangleMesh mesh = make_grid(options(2.0, 6.0, 3, 4));
  ASSERT_EQ(mesh.vertices.cols(), 12);
  ASSERT_EQ(mesh.triangles.cols(), 12);
  EXPECT_EQ(mesh.vertices.col(0), Eigen::Vector3d(-1.0, -3.0, 0.0));
  EXPECT_EQ(mesh.vertices.col(1), Eigen::Vector3d(0.0, -3.0, 0.0));
  EXPECT_EQ(mesh.vertices.col(3), Eigen::Vector3d(-1.0, -1.0, 0.0));
  EXPECT_EQ(mesh.vertices.col(11), Eigen::Vector3d(1.0, 3.0, 0.0));
}

TEST(MakeGrid, IsAValidMeshThatFacesUp) {
  const TriangleMesh mesh = make_grid(options(0.3, 0.7, 11, 6));
  EXPECT_NO_THROW(validate(mesh, "grid"));
  EXPECT_NEAR(area(mesh), 0.21, 1e-12);
  const Eigen::Matrix3Xd normals = vertex_normals(mesh);
  for (int v = 0; v < normals.cols(); ++v) EXPECT_NEAR(normals(2, v), 1.0, 1e-12);
}

TEST(MakeGrid, AlternatesDiagonals) {
  const Edges all = edges(make_grid(options(1.0, 1.0, 3, 3)));
  int rising = 0, falling = 0;
  for (const auto& edge : all.vertices) {
    rising += edge[1] - edge[0] == 4;
    falling += edge[1] - edge[0] == 2 && edge[0] % 3 != 0;
  }
  EXPECT_EQ(rising, 2);
  EXPECT_EQ(falling, 2);
}

TEST(MakeGrid, RefusesBadOptions) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { make_grid(options(bad, 1.0, 2, 2)); }, {"grid: width", "(0, inf)"});
    expect_refusal([&] { make_grid(options(1.0, bad, 2, 2)); }, {"grid: height", "(0, inf)"});
  }
  for (const int bad : {1, 0, -5, std::numeric_limits<int>::min()}) {
    expect_refusal([&] { make_grid(options(1.0, 1.0, bad, 2)); }, {"grid: columns", "2 or more"});
    expect_refusal([&] { make_grid(options(1.0, 1.0, 2, bad)); }, {"grid: rows", "2 or more"});
  }
}

TEST(MakeGrid, RefusesTooManyTriangles) {
  constexpr int kMost = std::numeric_limits<int>::max();
  expect_refusal([] { make_grid(options(1.0, 1.0, 3000, 3000)); }, {"at most 10000000"});
  expect_refusal([] { make_grid(options(1.0, 1.0, kMost, kMost)); }, {"at most 10000000"});
}

}  // namespace
}  // namespace pliant
