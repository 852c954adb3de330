#include "pliant/geometry/mesh/polygon.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace pliant {
namespace {

using Eigen::Vector3d;
using Corners = std::vector<Vector3d>;

// Positive areas that sum to the polygon's: no overlap, no gap, no flip, nothing degenerate.
void expect_area(const Corners& corners, double area, const Vector3d& normal) {
  const auto triangles = triangulate_polygon(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const double twice = (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(normal);
    EXPECT_GT(twice, 1e-9);
    sum += 0.5 * twice;
  }
  EXPECT_NEAR(sum, area, 1e-9);
}

TEST(TriangulatePolygon, CutsConvexOnes) {
  EXPECT_EQ(triangulate_polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 1u);
  expect_area({{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}, 1.0, Vector3d::UnitX());
}

TEST(TriangulatePolygon, CutsConcaveOnesWhoseDiagonalsTouchCorners) {
  expect_area({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 3.0,
              Vector3d::UnitZ());
  expect_area({{0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0, 0}, {0, 0, 0}}, 3.0,
              -Vector3d::UnitZ());
  // An arrow head.
  expect_area({{0, 0, 0}, {2, -1, 0}, {0.5, 0, 0}, {2, 1, 0}}, 0.5, Vector3d::UnitZ());
}

TEST(TriangulatePolygon, CutsOnesWithCornersOnStraightSides) {
  expect_area({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, 3, 0}}, 4.5, Vector3d::UnitZ());
}

TEST(TriangulatePolygon, CutsStars) {
  Corners star;
  double area = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double r = i % 2 ? 1.0 : 0.3;
    star.emplace_back(r * std::cos(M_PI * i / 20), r * std::sin(M_PI * i / 20), 5.0);
    area += 0.5 * 0.3 * std::sin(M_PI / 20);
  }
  expect_area(star, area, Vector3d::UnitZ());
}

TEST(TriangulatePolygon, GivesSomethingForPolygonsThatAreNone) {
  EXPECT_TRUE(triangulate_polygon({}).empty());
  EXPECT_TRUE(triangulate_polygon({{0, 0, 0}, {1, 0, 0}}).empty());
  EXPECT_EQ(triangulate_polygon(Corners(6, Vector3d::Ones())).size(), 4u);
  EXPECT_EQ(triangulate_polygon(Corners(5, Vector3d::Constant(std::nan("")))).size(), 3u);
  EXPECT_EQ(triangulate_polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
}

}  // namespace
}  // namespace pliant
