#include "pliant/geometry/search/nearest_triangle.h"

#include <gtest/gtest.h>

#include "pliant/geometry/distance/closest_point.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

TEST(NearestTriangle, FindsWhatATrialOfAllFinds) {
  const TriangleMesh torus = torus_surface(1.0, 0.4, 15, 9);
  const NearestTriangle nearest(torus);
  Random random(8);
  int hint = -1;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d p = random.vector(2.0);
    double best = std::numeric_limits<double>::infinity();
    for (const auto t : torus.triangles.colwise()) {
      const Eigen::Vector3d q = closest_point_on_triangle(
          p, torus.vertices.col(t[0]), torus.vertices.col(t[1]), torus.vertices.col(t[2]));
      best = std::min(best, (q - p).norm());
    }
    const NearestTriangle::Result result = nearest(p);
    EXPECT_DOUBLE_EQ(result.distance, best);
    EXPECT_DOUBLE_EQ((result.point - p).norm(), best);
    EXPECT_EQ(nearest.near(p, hint).distance, result.distance);
    hint = result.triangle;
  }
}

}  // namespace
}  // namespace pliant
