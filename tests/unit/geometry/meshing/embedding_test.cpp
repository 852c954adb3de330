#include "pliant/geometry/meshing/embedding.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/geometry/meshing/stuffing.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

TEST(Embedding, WeightsGiveThePointsBackWithinAndWithout) {
  const TetrahedralMesh block = make_block({{1, 1, 1}, {3, 4, 5}});
  Random random(3);
  const Eigen::Matrix3Xd points = random.positions(500, 0.8);
  const Embedding embedding = embed(points, block);
  int inside = 0;
  for (int i = 0; i < points.cols(); ++i) {
    EXPECT_NEAR(embedding.weights.col(i).sum(), 1.0, 1e-14);
    const bool is_inside = points.col(i).cwiseAbs().maxCoeff() <= 0.5;
    EXPECT_EQ(embedding.weights.col(i).minCoeff() >= 0.0, is_inside) << points.col(i).transpose();
    inside += is_inside ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
  EXPECT_LT(inside, 450);
  const Eigen::Matrix3Xd back = embedded_positions(embedding, block.tetrahedra, block.vertices);
  EXPECT_LT((back - points).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(Embedding, PointsFollowAnAffineMapOfTheMesh) {
  const TriangleMesh sphere = icosphere(3);
  const TetrahedralMesh mesh = stuff(sphere, {0.3, 10'000, -1.0});
  const Embedding embedding = embed(sphere.vertices, mesh);
  Random random(4);
  const Eigen::Matrix3d a = Eigen::Matrix3d::Identity() + 0.3 * random.rotation();
  const Eigen::Vector3d b = random.vector(1.0);
  const Eigen::Matrix3Xd after = (a * mesh.vertices).colwise() + b;
  const Eigen::Matrix3Xd expected = (a * sphere.vertices).colwise() + b;
  const Eigen::Matrix3Xd got = embedded_positions(embedding, mesh.tetrahedra, after);
  EXPECT_LT((got - expected).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(Embedding, PointsOutsideTakeTheTetrahedronBehindTheNearestTriangle) {
  const TetrahedralMesh block = make_block({{1, 1, 1}, {2, 2, 2}});
  Eigen::Matrix3Xd point(3, 1);
  point << 0.9, 0.3, 0.2;
  const Embedding embedding = embed(point, block);
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    const int v = block.tetrahedra(k, embedding.tetrahedron[0]);
    nearest = std::min(nearest, (block.vertices.col(v) - point).norm());
  }
  EXPECT_LT(nearest, 0.75);  // a corner of the cell in front of it
  EXPECT_LT(embedding.weights.col(0).minCoeff(), 0.0);
}

TEST(Embedding, PointsThatAreNotFiniteAreRefused) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 4);
  points(2, 1) = std::numeric_limits<double>::quiet_NaN();
  expect_refusal([&] { embed(points, make_block({}), "skin"); },
                 {"skin: 1 points are not finite: 1"});
}

}  // namespace
}  // namespace pliant
