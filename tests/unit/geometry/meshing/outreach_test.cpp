#include "pliant/geometry/meshing/outreach.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/mesh/tetrahedron_faces.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace outreach_test {
namespace {

const TetrahedralMesh kBlock = make_block({{0.1, 0.1, 0.1}, {4, 4, 4}});

TriangleMesh boundary(double scale) {
  return {scale * kBlock.vertices, boundary_triangles(kBlock)};
}

TEST(Outreach, OfWhatTetrahedraHoldIsNoneToTheTolerance) {
  for (const double tolerance : {0.001, 0.0003}) {
    EXPECT_LE(outreach(boundary(0.7), kBlock, tolerance, "test"), tolerance);
    EXPECT_LE(outreach(boundary(1.0), kBlock, tolerance, "test"), tolerance);
  }
}

TEST(Outreach, IsThatOfTheFarthestPlaceToTheTolerance) {
  // Corners stand out most, by the diagonal of a cube.
  const double exact = 0.05 * 0.3 * std::sqrt(3.0);
  for (const double tolerance : {0.003, 0.001, 0.0003}) {
    const double found = outreach(boundary(1.3), kBlock, tolerance, "test");
    EXPECT_GE(found, exact * (1.0 - 1e-12));
    EXPECT_LE(found, exact + tolerance);
  }
}

TEST(Outreach, SeesAPlaceBetweenTheCornersOfATriangle) {
  // Two blocks with a gap of 0.1 m, and a large triangle whose corners lie in them.
  TetrahedralMesh pair = kBlock;
  const Eigen::Index count = kBlock.vertices.cols();
  pair.vertices.conservativeResize(3, 2 * count);
  pair.vertices.rightCols(count) = kBlock.vertices.colwise() + Eigen::Vector3d(0.2, 0.0, 0.0);
  const Eigen::Index elements = kBlock.tetrahedra.cols();
  pair.tetrahedra.conservativeResize(4, 2 * elements);
  pair.tetrahedra.rightCols(elements) = kBlock.tetrahedra.array() + static_cast<int>(count);
  TriangleMesh bridge{Eigen::Matrix3Xd(3, 3), Eigen::Vector3i(0, 1, 2)};
  bridge.vertices << 0.0, 0.2, 0.0,  //
      0.0, 0.0, 0.01,                //
      0.0, 0.0, 0.0;
  const double found = outreach(bridge, pair, 0.002, "test");
  EXPECT_GE(found, 0.05 * (1.0 - 1e-12));
  EXPECT_LE(found, 0.052);
}

TEST(Outreach, RefusesWhatIsNotFinite) {
  TriangleMesh surface = boundary(1.0);
  surface.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
  expect_refusal([&] { outreach(surface, kBlock, 0.001, "test"); }, {"test", "not finite"});
}

}  // namespace
}  // namespace outreach_test
}  // namespace pliant
