#include "pliant/geometry/search/mesh_distances.h"

#include <gtest/gtest.h>

#include <limits>

#include "pliant/geometry/search/nearest_triangle.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace mesh_distances_test {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

MeshDistances::Points points_about(const Eigen::Vector3d& middle, double size, Random& random) {
  MeshDistances::Points points;
  for (std::size_t l = 0; l < MeshDistances::kLanes; ++l) {
    const Eigen::Vector3d p = middle + random.vector(size);
    points.x[l] = p[0];
    points.y[l] = p[1];
    points.z[l] = p[2];
  }
  return points;
}

Eigen::Vector3d point(const MeshDistances::Points& points, std::size_t l) {
  return {points.x[l], points.y[l], points.z[l]};
}

/// That distances, without a limit and with one of each point's own, are those of one point at a
/// time, to the last bit.
void expect_as_alone(const TriangleMesh& mesh, const MeshDistances::Points& points, int& hint) {
  const MeshDistances mesh_distances(mesh);
  const NearestTriangle nearest(mesh);
  MeshDistances::Lanes found, limited, limits;
  found.fill(kUnlimited);
  for (std::size_t l = 0; l < limits.size(); ++l) {
    limits[l] = nearest(point(points, l)).distance * (l % 2 == 0 ? 0.99 : 1.01);
  }
  limited = limits;
  mesh_distances.lower(points, found, hint);
  mesh_distances.lower(points, limited, hint);
  for (std::size_t l = 0; l < found.size(); ++l) {
    const double alone = nearest(point(points, l)).distance;
    EXPECT_EQ(found[l], alone);
    EXPECT_EQ(limited[l], l % 2 == 0 ? limits[l] : alone);
  }
  EXPECT_GE(hint, 0);
}

TEST(MeshDistances, AreThoseOfOnePointAtATime) {
  const TriangleMesh torus = torus_surface(1.0, 0.4, 15, 9);
  Random random(8);
  int hint = -1;
  for (int i = 0; i < 100; ++i) {
    // Near each other, as samples of a grid are, and anywhere.
    const MeshDistances::Points points =
        points_about(random.vector(2.0), i % 2 == 0 ? 0.05 : 2.0, random);
    expect_as_alone(torus, points, hint);
  }
}

TEST(MeshDistances, OfTrianglesWithoutArea) {
  TriangleMesh mesh{Eigen::Matrix3Xd(3, 6), Eigen::Matrix3Xi(3, 4)};
  mesh.vertices << 0, 1, 2, 0, 0.5, 0.5,  //
      0, 0, 0, 1, 0.5, 0.5,               //
      0, 0, 0, 0, 1, 1;
  // One with area, a line, a line with two equal corners, a point.
  mesh.triangles << 0, 0, 3, 4,  //
      1, 1, 4, 5,                //
      3, 2, 5, 4;
  Random random(9);
  int hint = -1;
  for (int i = 0; i < 50; ++i) expect_as_alone(mesh, points_about({0, 0, 0}, 2.0, random), hint);
}

TEST(MeshDistances, OfNothingAreTheLimits) {
  Random random(10);
  int hint = -1;
  MeshDistances::Lanes distances;
  distances.fill(3.0);
  const MeshDistances none(TriangleMesh{Eigen::Matrix3Xd(3, 0), Eigen::Matrix3Xi(3, 0)});
  none.lower(points_about({0, 0, 0}, 1.0, random), distances, hint);
  for (const double distance : distances) EXPECT_EQ(distance, 3.0);
  EXPECT_EQ(hint, -1);
}

}  // namespace
}  // namespace mesh_distances_test
}  // namespace pliant
