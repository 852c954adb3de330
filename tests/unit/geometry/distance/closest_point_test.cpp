#include "pliant/geometry/distance/closest_point.h"

#include <gtest/gtest.h>

#include <random>

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(ClosestPointOnTriangle, FindsFaceEdgesAndCorners) {
  const Vector3d a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_TRUE(closest_point_on_triangle({0.25, 0.25, 3}, a, b, c).isApprox(Vector3d(.25, .25, 0)));
  EXPECT_TRUE(closest_point_on_triangle({0.5, -2, 1}, a, b, c).isApprox(Vector3d(0.5, 0, 0)));
  EXPECT_TRUE(closest_point_on_triangle({1, 1, 0}, a, b, c).isApprox(Vector3d(0.5, 0.5, 0)));
  EXPECT_EQ(closest_point_on_triangle({5, -1, 0}, a, b, c), b);
  EXPECT_EQ(closest_point_on_triangle({-1, -1, -1}, a, b, c), a);
}

TEST(ClosestPointOnTriangle, IsNoFartherThanAnySample) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto point = [&] { return Vector3d(uniform(random), uniform(random), uniform(random)); };
  for (int i = 0; i < 200; ++i) {
    const Vector3d a = point(), b = point(), c = point(), p = 2.0 * point();
    const double distance = (closest_point_on_triangle(p, a, b, c) - p).norm();
    double sampled = 1e9;
    for (int u = 0; u <= 100; ++u) {
      for (int v = 0; u + v <= 100; ++v) {
        sampled = std::min(sampled, (a + u / 100.0 * (b - a) + v / 100.0 * (c - a) - p).norm());
      }
    }
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_NEAR(distance, sampled, 0.02);
  }
}

TEST(ClosestPointOnTriangle, TakesTrianglesWithoutArea) {
  const Vector3d a(1, 1, 1), b(2, 1, 1);
  EXPECT_EQ(closest_point_on_triangle({0, 0, 0}, a, a, a), a);
  EXPECT_EQ(closest_point_on_triangle({1.5, 0, 0}, a, b, a), Vector3d(1.5, 1, 1));
}

}  // namespace
}  // namespace pliant
