#include "pliant/geometry/meshing/hole_filling.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

TEST(HoleFilling, AClosedMeshHasNone) { EXPECT_TRUE(find_holes(icosphere(1)).empty()); }

TEST(HoleFilling, ClosesAMissingTriangle) {
  const TriangleMesh whole = icosphere(2);
  TriangleMesh mesh = without_last(whole, 1);
  const std::vector<Hole> holes = find_holes(mesh);
  ASSERT_EQ(holes.size(), 1u);
  EXPECT_EQ(holes[0].rim.size(), 3u);
  const auto lost = whole.triangles.rightCols(1);
  Eigen::AlignedBox3d bounds;
  for (int k = 0; k < 3; ++k) bounds.extend(Eigen::Vector3d(whole.vertices.col(lost(k))));
  EXPECT_EQ(holes[0].width, bounds.sizes().maxCoeff());
  fill_holes(mesh, holes);
  EXPECT_NO_THROW(validate(mesh, "filled"));
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  EXPECT_NEAR(signed_volume(mesh), signed_volume(whole), 1e-14);
}

TEST(HoleFilling, PartsHolesThatTouchInAVertex) {
  // Two triangles of a vertex's fan that share no edge.
  TriangleMesh mesh = icosphere(1);
  const int vertex = mesh.triangles(0, 0);
  std::vector<int> fan;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if ((mesh.triangles.col(t).array() == vertex).any()) fan.push_back(t);
  }
  int other = -1;
  for (const int t : fan) {
    int common = 0;
    for (int k = 0; k < 3; ++k) {
      common += (mesh.triangles.col(t).array() == mesh.triangles(k, fan[0])).any();
    }
    if (common == 1) other = t;
  }
  ASSERT_GT(other, fan[0]);
  Eigen::Matrix3Xi kept(3, mesh.triangles.cols() - 2);
  int n = 0;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (t != fan[0] && t != other) kept.col(n++) = mesh.triangles.col(t);
  }
  const double volume = signed_volume(mesh);
  mesh.triangles = kept;
  const std::vector<Hole> holes = find_holes(mesh);
  ASSERT_EQ(holes.size(), 2u);
  fill_holes(mesh, holes);
  EXPECT_NO_THROW(validate(mesh, "filled"));
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  EXPECT_NEAR(signed_volume(mesh), volume, 1e-14);
}

}  // namespace
}  // namespace pliant
