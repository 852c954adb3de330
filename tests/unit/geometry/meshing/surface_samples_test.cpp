#include "pliant/geometry/meshing/surface_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

/// A square of two triangles, 1 m wide.
TriangleMesh square() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,               //
      0, 0, 0, 0;
  mesh.triangles.resize(3, 2);
  mesh.triangles << 0, 0,  //
      1, 2,                //
      2, 3;
  return mesh;
}

double nearest(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& to, Eigen::Index but = -1) {
  double least = INFINITY;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (k != but) least = std::min(least, (points.col(k) - to).norm());
  }
  return least;
}

TEST(SurfaceSamples, CoverTheSurfaceAndKeepTheirDistance) {
  for (const double spacing : {0.03, 0.1, 0.5}) {
    const Eigen::Matrix3Xd points = sample_surface(square(), spacing);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      EXPECT_EQ(points(2, k), 0.0);
      EXPECT_GE(nearest(points, points.col(k), k), 0.5 * spacing * (1.0 - 1e-12));
    }
    for (double x = 0.0; x <= 1.0; x += 0.0625) {
      for (double y = 0.0; y <= 1.0; y += 0.0625) {
        EXPECT_LE(nearest(points, {x, y, 0.0}), spacing) << x << ' ' << y;
      }
    }
  }
}

TEST(SurfaceSamples, HoldEveryVertexThatIsApart) {
  const Eigen::Matrix3Xd points = sample_surface(square(), 0.2);
  const Eigen::Matrix3Xd vertices = square().vertices;
  for (const auto vertex : vertices.colwise()) {
    EXPECT_EQ(nearest(points, vertex), 0.0);
  }
}

TEST(SurfaceSamples, MeanEdgeLength) {
  EXPECT_NEAR(mean_edge_length(square()), (4.0 + 2.0 * std::sqrt(2.0)) / 6.0, 1e-15);
}

TEST(SurfaceSamples, RefuseWhatHasNoEnd) {
  for (const double spacing : {0.0, -1.0, std::nan(""), double{INFINITY}}) {
    expect_refusal([&] { sample_surface(square(), spacing); }, {"spacing"});
  }
  expect_refusal([] { sample_surface(square(), 1e-9); }, {"spacing of 1e-09 m", "at most"});
}

}  // namespace
}  // namespace pliant
