#include "pliant/geometry/distance/winding_count.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/math/joined.h"
#include "pliant/math/pi.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

/// By the solid angles of all triangles.
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
  double angle = 0.0;
  for (const auto t : mesh.triangles.colwise()) {
    const Eigen::Vector3d a = mesh.vertices.col(t[0]) - p, b = mesh.vertices.col(t[1]) - p,
                          c = mesh.vertices.col(t[2]) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2.0 * std::atan2(a.dot(b.cross(c)),
                              la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4.0 * kPi);
}

TEST(WindingCount, IsThatOfSolidAngles) {
  const TriangleMesh torus = torus_surface(1.0, 0.4, 15, 9);
  const WindingCount winding(torus);
  Random random(3);
  int within = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d p = random.vector(1.5);
    const int count = winding(p);
    EXPECT_EQ(count, std::lround(winding_number(torus, p))) << p.transpose();
    within += count;
  }
  EXPECT_GT(within, 20);
}

TEST(WindingCount, CountsRaysThroughEdgesAndCornersOnce) {
  // Seen from above, corners and edges of the box lie in columns with these points.
  const WindingCount winding(Box(Eigen::Vector3d(2.0, 2.0, 2.0)).surface());
  for (const double x : {-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5}) {
    for (const double y : {-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5}) {
      const bool is_within = std::abs(x) < 1.0 && std::abs(y) < 1.0;
      for (const double z : {-1.5, -0.25, 0.5, 1.5}) {
        const int count = winding({x, y, z});
        // On the sides either is right.
        if (std::max(std::abs(x), std::abs(y)) == 1.0 && std::abs(z) < 1.0) continue;
        EXPECT_EQ(count, is_within && std::abs(z) < 1.0 ? 1 : 0) << x << " " << y << " " << z;
      }
    }
  }
}

TEST(WindingCount, AVertexOfARoundSurfaceAboveAPointCountsOnce) {
  const TriangleMesh sphere = Sphere(0.1).surface();
  const WindingCount winding(sphere);
  for (const auto vertex : sphere.vertices.colwise()) {
    EXPECT_EQ(winding(0.9 * vertex), 1);
    EXPECT_EQ(winding({vertex.x(), vertex.y(), -0.2}), 0);
  }
}

TEST(WindingCount, AHollowIsOutside) {
  TriangleMesh shell = Sphere(0.1).surface();
  TriangleMesh inner = Sphere(0.05).surface();
  inner.triangles.row(1).swap(inner.triangles.row(2));
  const auto first = static_cast<int>(shell.vertices.cols());
  shell.triangles = beside(shell.triangles, Eigen::Matrix3Xi(inner.triangles.array() + first));
  shell.vertices = beside(shell.vertices, inner.vertices);
  const WindingCount winding(shell);
  EXPECT_EQ(winding({0.0, 0.0, 0.0}), 0);
  EXPECT_EQ(winding({0.07, 0.0, 0.0}), 1);
  EXPECT_EQ(winding({0.0, 0.0, 0.2}), 0);
}

}  // namespace
}  // namespace pliant
