#include "pliant/effects/column_volume.h"

#include <gtest/gtest.h>

#include "pliant/geometry/grid.h"
#include "support/random.h"

namespace pliant {
namespace {

/// A fan of `sides` triangles from an apex at `height` to a regular polygon of radius 1 at z = 0.
void make_cone(int sides, double height, Positions& x, Eigen::Matrix3Xi& triangles) {
  x.setZero(3, sides + 1);
  triangles.resize(3, sides);
  x(2, sides) = height;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * M_PI * k / sides;
    x.col(k) << std::cos(angle), std::sin(angle), 0.0;
    triangles.col(k) << k, (k + 1) % sides, sides;
  }
}

TEST(ColumnVolume, OfPyramidsAndConesIsExact) {
  for (const int sides : {3, 4, 6, 100}) {
    Positions x;
    Eigen::Matrix3Xi triangles;
    make_cone(sides, 0.7, x, triangles);
    const double base = 0.5 * sides * std::sin(2.0 * M_PI / sides);
    EXPECT_NEAR(column_volume(triangles, x, Ground()), base * 0.7 / 3.0, 1e-14);
    // Raised by the distance to a lower ground, a prism comes underneath.
    EXPECT_NEAR(column_volume(triangles, x, {Eigen::Vector3d::UnitZ(), -2.0}),
                base * (0.7 / 3.0 + 2.0), 1e-13);
  }
}

TEST(ColumnVolume, FlatOnTheGroundIsZero) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  EXPECT_EQ(column_volume(mesh.triangles, mesh.vertices, Ground()), 0.0);
}

TEST(ColumnVolume, BelowTheGroundCountsAsZero) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  EXPECT_EQ(column_volume(mesh.triangles, mesh.vertices, {Eigen::Vector3d::UnitZ(), 3.0}), 0.0);
}

TEST(ColumnVolume, FoldedTrianglesCountNegative) {
  Eigen::Matrix3Xi triangles(3, 1);
  triangles << 0, 1, 2;
  Positions x(3, 3);
  x << 0, 1, 0, 0, 0, 1, 1, 1, 1;
  EXPECT_DOUBLE_EQ(column_volume(triangles, x, Ground()), 0.5);
  x.col(1).swap(x.col(2));
  EXPECT_DOUBLE_EQ(column_volume(triangles, x, Ground()), -0.5);
  x.col(2) = 2.0 * x.col(1) - x.col(0);
  EXPECT_DOUBLE_EQ(column_volume(triangles, x, Ground()), 0.0);
}

TEST(ColumnVolume, AnyGround) {
  Random random(5);
  Positions x;
  Eigen::Matrix3Xi triangles;
  make_cone(5, 0.4, x, triangles);
  const double volume = column_volume(triangles, x, {Eigen::Vector3d::UnitZ(), -0.1});
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Matrix3d rotation = random.rotation();
    const Eigen::Vector3d shift = random.vector(2.0);
    Ground ground;
    ground.normal = rotation.col(2);
    ground.level = ground.normal.dot(shift) - 0.1;
    const Positions moved = (rotation * x).colwise() + shift;
    EXPECT_NEAR(column_volume(triangles, moved, ground), volume, 1e-13);
  }
}

TEST(ColumnVolume, GradientByDifferences) {
  Random random(9);
  const TriangleMesh mesh = make_grid({1.0, 1.0, 5, 5});
  Ground ground;
  ground.normal = random.vector(1.0).normalized();
  ground.level = -3.0;  // everything is above it: V is a polynomial
  const Positions x = mesh.vertices + random.positions(25, 0.2);
  Eigen::Matrix3Xd gradient;
  column_volume_gradient(mesh.triangles, x, ground, gradient);
  const double h = 1e-4;
  for (int k = 0; k < x.size(); ++k) {
    Positions up = x, down = x;
    up.data()[k] += h;
    down.data()[k] -= h;
    const double slope = (column_volume(mesh.triangles, up, ground) -
                          column_volume(mesh.triangles, down, ground)) / (2.0 * h);
    // The cubic part's h² and 1e-16 of 3 m³ over h.
    EXPECT_NEAR(gradient.data()[k], slope, 1e-8 + 1e-15 * 3.0 / h);
  }
}

TEST(ColumnVolume, HorizontalShiftsChangeNothing) {
  Random random(2);
  const TriangleMesh mesh = make_grid({1.0, 1.0, 5, 5});
  Positions x = mesh.vertices + random.positions(25, 0.1);
  x.row(2).array() += 0.5;
  Eigen::Matrix3Xd gradient;
  column_volume_gradient(mesh.triangles, x, Ground(), gradient);
  const Eigen::Vector3d sum = gradient.rowwise().sum();
  EXPECT_NEAR(sum.x(), 0.0, 1e-14);
  EXPECT_NEAR(sum.y(), 0.0, 1e-14);
  // Lifting adds the projected area per metre.
  const Positions lifted = x.colwise() + Eigen::Vector3d(0, 0, 1);
  EXPECT_NEAR(sum.z(), column_volume(mesh.triangles, lifted, Ground()) -
                           column_volume(mesh.triangles, x, Ground()), 1e-14);
}

TEST(ColumnVolume, GradientOnTheGroundPointsUp) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  Eigen::Matrix3Xd gradient;
  column_volume_gradient(mesh.triangles, mesh.vertices, Ground(), gradient);
  EXPECT_NEAR(gradient.row(2).sum(), 1.0, 1e-14);
  EXPECT_GT(gradient.row(2).minCoeff(), 0.0);
}

}  // namespace
}  // namespace pliant
