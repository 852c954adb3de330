#include "pliant/geometry/meshing/simplify.h"

#include <gtest/gtest.h>

#include "pliant/geometry/mesh/display_surface.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "support/expect_refusal.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

TEST(Simplify, KeepsAClosedTorusNearAndItsVerticesOnIt) {
  const TriangleMesh torus = torus_surface(1.0, 0.4, 60, 36);
  const TriangleMesh coarse = simplify(torus, 300);
  EXPECT_LE(coarse.triangles.cols(), 300);
  EXPECT_GE(coarse.triangles.cols(), 290);
  EXPECT_NO_THROW(validate(coarse, "coarse"));
  const Edges all = edges(coarse);
  EXPECT_TRUE(boundary_vertices(coarse).empty());
  EXPECT_EQ(
      coarse.vertices.cols() - static_cast<long>(all.vertices.size()) + coarse.triangles.cols(), 0);
  for (const auto v : coarse.vertices.colwise()) {
    EXPECT_EQ((torus.vertices.colwise() - v).colwise().squaredNorm().minCoeff(), 0.0);
  }
  const NearestTriangle nearest(coarse);
  for (const auto v : torus.vertices.colwise()) EXPECT_LT(nearest(v).distance, 0.1);
}

TEST(Simplify, TakesAwayWhatIsThinFromTheStart) {
  const TriangleMesh coarse = simplify(cylinder_surface(0.5, 1.0), 100);
  EXPECT_LE(coarse.triangles.cols(), 100);
  EXPECT_NO_THROW(validate(coarse, "cylinder"));
  EXPECT_TRUE(boundary_vertices(coarse).empty());
}

TEST(Simplify, LeavesASmallMeshAlone) {
  const TriangleMesh ball = icosphere(1);
  EXPECT_EQ(simplify(ball, 80).vertices, ball.vertices);
  EXPECT_EQ(simplify(ball, 1000).triangles, ball.triangles);
}

TEST(Simplify, GivesTheSameMeshEveryTime) {
  const TriangleMesh ball = icosphere(3);
  const TriangleMesh a = simplify(ball, 100), b = simplify(ball, 100);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(Simplify, RefusesTwoFansAboutAVertex) {
  // Two balls that share their first vertex.
  const TriangleMesh ball = icosphere(2);
  TriangleMesh pair = together(ball, moved(ball, 2.0 * ball.vertices.col(0)));
  const Eigen::Vector3d meeting = ball.vertices.col(0);
  const int count = static_cast<int>(ball.vertices.cols());
  int touching = -1;
  for (int v = count; v < 2 * count; ++v) {
    if ((pair.vertices.col(v) - meeting).norm() < 1e-12) touching = v;
  }
  ASSERT_GE(touching, 0);
  for (int t = 0; t < pair.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (pair.triangles(k, t) == touching) pair.triangles(k, t) = 0;
    }
  }
  expect_refusal([&] { simplify(pair, 100, "pair.obj"); }, {"pair.obj: triangle", "not manifold"});
}

}  // namespace
}  // namespace pliant
