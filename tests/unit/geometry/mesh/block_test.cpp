#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

BlockOptions options(const Eigen::Vector3d& size, const Eigen::Vector3i& cells) {
  return {size, cells};
}

TEST(MakeBlock, OrdersVerticesByLayerRowColumn) {
  const TetrahedralMesh mesh = make_block(options({2, 4, 6}, {1, 2, 3}));
  ASSERT_EQ(mesh.vertices.cols(), 2 * 3 * 4);
  ASSERT_EQ(mesh.tetrahedra.cols(), 5 * 6);
  EXPECT_EQ(mesh.vertices.col(0), Eigen::Vector3d(-1, -2, -3));
  EXPECT_EQ(mesh.vertices.col(1), Eigen::Vector3d(1, -2, -3));
  EXPECT_EQ(mesh.vertices.col(2), Eigen::Vector3d(-1, 0, -3));
  EXPECT_EQ(mesh.vertices.col(6), Eigen::Vector3d(-1, -2, -1));
  EXPECT_EQ(mesh.vertices.col(23), Eigen::Vector3d(1, 2, 3));
}

TEST(MakeBlock, IsAValidMeshOfItsVolumeAndSurface) {
  const TetrahedralMesh mesh = make_block(options({0.2, 0.3, 0.5}, {3, 4, 5}));
  EXPECT_NO_THROW(validate(mesh, "block"));
  EXPECT_NEAR(volumes(mesh).sum(), 0.03, 1e-15);
  EXPECT_GT(volumes(mesh).minCoeff(), 0.0);
  EXPECT_NEAR(vertex_volumes(mesh).sum(), 0.03, 1e-15);
  TriangleMesh surface;
  const Eigen::Matrix3Xi triangles = boundary_triangles(mesh);
  EXPECT_EQ(triangles.cols(), 2 * 2 * (12 + 15 + 20));
  surface.vertices = mesh.vertices;
  surface.triangles = triangles;
  EXPECT_NEAR(area(surface), 2 * (0.06 + 0.1 + 0.15), 1e-14);
  EXPECT_NEAR(signed_volume(surface), 0.03, 1e-15);
}

/// Each tetrahedron as the set of its vertices after `mirror` along one axis.
std::set<std::vector<int>> mirrored(const TetrahedralMesh& mesh, const Eigen::Vector3i& cells,
                                    int axis) {
  std::set<std::vector<int>> result;
  for (const auto tetrahedron : mesh.tetrahedra.colwise()) {
    std::vector<int> corners;
    for (int v : tetrahedron) {
      Eigen::Vector3i at(v % (cells[0] + 1), v / (cells[0] + 1) % (cells[1] + 1),
                         v / ((cells[0] + 1) * (cells[1] + 1)));
      if (axis >= 0) at[axis] = cells[axis] - at[axis];
      corners.push_back((at[2] * (cells[1] + 1) + at[1]) * (cells[0] + 1) + at[0]);
    }
    std::sort(corners.begin(), corners.end());
    result.insert(corners);
  }
  return result;
}

TEST(MakeBlock, EvenCellsMakeItItsOwnMirrorImage) {
  const Eigen::Vector3i cells(2, 4, 6);
  const TetrahedralMesh mesh = make_block(options({1, 1, 1}, cells));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(mirrored(mesh, cells, axis), mirrored(mesh, cells, -1)) << axis;
  }
}

TEST(MakeBlock, RefusesBadOptions) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal(
        [&] {
          make_block(options({1, bad, 1}, {1, 1, 1}));
        },
        {"block: size along y", "(0, inf)"});
  }
  for (const int bad : {0, -5, std::numeric_limits<int>::min()}) {
    expect_refusal(
        [&] {
          make_block(options({1, 1, 1}, {1, 1, bad}));
        },
        {"block: cells along z", "1 or more"});
  }
  const int most = std::numeric_limits<int>::max();
  expect_refusal(
      [&] {
        make_block(options({1, 1, 1}, {most, most, most}));
      },
      {"more than 10000000 tetrahedra", "fewer cells"});
}

}  // namespace
}  // namespace pliant
