#include "pliant/effects/air/column_volume.h"

#include <gtest/gtest.h>

#include "pliant/effects/air/trapped_volume.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/random.h"

namespace pliant::column_volume_test {
namespace {

/// A third of each triangle for each corner: exact for surfaces of flat triangles.
CoverTriangles thirds(const Eigen::Matrix3Xi& triangles) {
  return {triangles, Eigen::Matrix3Xd::Constant(3, triangles.cols(), 1.0 / 3.0)};
}

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
    EXPECT_NEAR(column_volume(thirds(triangles), x, Ground()), base * 0.7 / 3.0, 1e-14);
    // Raised by the distance to a lower ground, a prism comes underneath.
    EXPECT_NEAR(column_volume(thirds(triangles), x, {Eigen::Vector3d::UnitZ(), -2.0}),
                base * (0.7 / 3.0 + 2.0), 1e-13);
  }
}

TEST(ColumnVolume, FlatOnTheGroundIsZero) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  EXPECT_EQ(column_volume(thirds(mesh.triangles), mesh.vertices, Ground()), 0.0);
}

TEST(ColumnVolume, BelowTheGroundCountsAsZero) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  EXPECT_EQ(column_volume(thirds(mesh.triangles), mesh.vertices, {Eigen::Vector3d::UnitZ(), 3.0}),
            0.0);
}

TEST(ColumnVolume, FoldedTrianglesCountNegative) {
  Eigen::Matrix3Xi triangles(3, 1);
  triangles << 0, 1, 2;
  Positions x(3, 3);
  x << 0, 1, 0, 0, 0, 1, 1, 1, 1;
  EXPECT_DOUBLE_EQ(column_volume(thirds(triangles), x, Ground()), 0.5);
  x.col(1).swap(x.col(2));
  EXPECT_DOUBLE_EQ(column_volume(thirds(triangles), x, Ground()), -0.5);
  x.col(2) = 2.0 * x.col(1) - x.col(0);
  EXPECT_DOUBLE_EQ(column_volume(thirds(triangles), x, Ground()), 0.0);
}

TEST(ColumnVolume, AnyGround) {
  Random random(5);
  Positions x;
  Eigen::Matrix3Xi triangles;
  make_cone(5, 0.4, x, triangles);
  const double volume = column_volume(thirds(triangles), x, {Eigen::Vector3d::UnitZ(), -0.1});
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Matrix3d rotation = random.rotation();
    const Eigen::Vector3d shift = random.vector(2.0);
    Ground ground;
    ground.normal = rotation.col(2);
    ground.level = ground.normal.dot(shift) - 0.1;
    const Positions moved = (rotation * x).colwise() + shift;
    EXPECT_NEAR(column_volume(thirds(triangles), moved, ground), volume, 1e-13);
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
  const CoverTriangles cover(mesh);
  column_volume_gradient(cover, x, ground, gradient);
  const double h = 1e-4;
  for (int k = 0; k < x.size(); ++k) {
    Positions up = x, down = x;
    up.data()[k] += h;
    down.data()[k] -= h;
    const double slope =
        (column_volume(cover, up, ground) - column_volume(cover, down, ground)) / (2.0 * h);
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
  const CoverTriangles cover(mesh);
  column_volume_gradient(cover, x, Ground(), gradient);
  const Eigen::Vector3d sum = gradient.rowwise().sum();
  EXPECT_NEAR(sum.x(), 0.0, 1e-14);
  EXPECT_NEAR(sum.y(), 0.0, 1e-14);
  // Lifting adds the projected area per metre.
  const Positions lifted = x.colwise() + Eigen::Vector3d(0, 0, 1);
  EXPECT_NEAR(sum.z(), column_volume(cover, lifted, Ground()) - column_volume(cover, x, Ground()),
              1e-14);
}

TEST(ColumnVolume, GradientOnTheGroundPointsUp) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 4, 4});
  Eigen::Matrix3Xd gradient;
  column_volume_gradient(CoverTriangles(mesh), mesh.vertices, Ground(), gradient);
  EXPECT_NEAR(gradient.row(2).sum(), 1.0, 1e-14);
  EXPECT_GT(gradient.row(2).minCoeff(), 0.0);
}

// A pressure under a flat sheet lifts all of its vertices alike, however its triangles lie: else
// every second one would come off wet ground before the others.
TEST(ColumnVolume, PressesOnEachVertexByItsMass) {
  Random random(4);
  TriangleMesh mesh = make_grid({1.0, 0.7, 6, 5});
  for (const bool is_regular : {true, false}) {
    if (!is_regular) mesh.vertices.topRows(2) += random.positions(30, 0.04).topRows(2);
    Positions x = mesh.vertices;
    x.row(2).array() += 0.1;
    const Eigen::VectorXd areas = voronoi_areas(mesh);
    Eigen::Matrix3Xd gradient;
    column_volume_gradient(CoverTriangles(mesh), x, Ground(), gradient);
    for (int i = 0; i < areas.size(); ++i) EXPECT_NEAR(gradient(2, i), areas[i], 1e-15) << i;
    FootPoints feet;
    trapped_volume_gradient(CoverTriangles(mesh), x, feet, gradient);
    for (int i = 0; i < areas.size(); ++i) EXPECT_NEAR(gradient(2, i), areas[i], 1e-15) << i;
  }
}

/// A strip of width 1 along y over a line in the x-z plane.
TriangleMesh strip(const std::vector<Eigen::Vector2d>& line) {
  TriangleMesh mesh;
  const auto n = static_cast<int>(line.size());
  mesh.vertices.resize(3, 2 * n);
  mesh.triangles.resize(3, 2 * (n - 1));
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector2d& p = line[static_cast<std::size_t>(i)];
    mesh.vertices.col(2 * i) << p.x(), 0.0, p.y();
    mesh.vertices.col(2 * i + 1) << p.x(), 1.0, p.y();
    if (i + 1 == n) break;
    mesh.triangles.col(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    mesh.triangles.col(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return mesh;
}

constexpr double kThickness = 0.002;

double layers_of(const TriangleMesh& mesh, double thickness = kThickness) {
  FootPoints foot_points;
  foot_points.are_flat = true;
  return layer_volume(mesh.triangles, mesh.vertices, foot_points, thickness);
}

double volume_of(const TriangleMesh& mesh) {
  return column_volume(thirds(mesh.triangles), mesh.vertices, Ground());
}

TEST(LayerVolume, AFinOfTwoLayersIsAllCloth) {
  const double half = 0.5 * kThickness;
  const TriangleMesh fin =
      strip({{-0.1, 0}, {-half, 0}, {-half, 0.04}, {half, 0.04}, {half, 0}, {0.1, 0}});
  EXPECT_NEAR(volume_of(fin), 0.04 * kThickness, 1e-15);
  EXPECT_NEAR(layers_of(fin), volume_of(fin), 1e-15);
  EXPECT_EQ(layers_of(fin, 0.0), 0.0);
}

// Upside down the middle one counts negative, and there is nothing between the three.
TEST(LayerVolume, AFoldOfThreeLayersIsAllCloth) {
  const TriangleMesh fold = strip({{-0.2, 0},
                                   {0.1, 0},
                                   {0.1, kThickness},
                                   {0, kThickness},
                                   {0, 2 * kThickness},
                                   {0.2, 2 * kThickness},
                                   {0.2, 0}});
  const double under_the_end = 0.1 * 2 * kThickness, ends = kThickness * kThickness;
  EXPECT_NEAR(volume_of(fold) - layers_of(fold), under_the_end, 3 * ends);
}

TEST(LayerVolume, LyingAndFlatLiftedClothIsNone) {
  for (const double height : {0.0, 0.03}) {
    EXPECT_NEAR(layers_of(strip({{-0.1, height}, {0.02, height}, {0.1, height}})), 0.0, 1e-18);
  }
}

// Under half a cylinder that stands on lying cloth, to the second order in the thickness: the inner
// face is half of it further in, the table as much below the middle of what lies on it.
TEST(LayerVolume, LeavesTheInsideOfHalfACylinder) {
  constexpr double kRadius = 0.03, kHalf = 0.5 * kThickness;
  std::vector<Eigen::Vector2d> line;
  for (int k = 0; k <= 400; ++k) {
    const double turn = M_PI * k / 400;
    line.emplace_back(-kRadius * std::cos(turn), kRadius * std::sin(turn));
  }
  const TriangleMesh half = strip(line);
  const double inner = kRadius - kHalf;
  const double exact = 0.5 * M_PI * inner * inner + 2.0 * inner * kHalf;
  EXPECT_NEAR(volume_of(half) - layers_of(half), exact, 0.5 * kThickness * kThickness);
  EXPECT_GT(volume_of(half) - exact, 4.0 * kThickness * kThickness) << "the test says nothing";
}

}  // namespace
}  // namespace pliant::column_volume_test
