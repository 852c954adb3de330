#include "pliant/elements/cloth/bending_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/mesh/grid.h"
#include "pliant/geometry/mesh/sheet_meshes.h"
#include "support/expect_refusal.h"
#include "support/random.h"

namespace pliant {
namespace {

TEST(BendingSet, HasOneHingePerInnerEdge) {
  // 3 (c-1)(r-1) + (c-1) + (r-1) edges less 2 (c-1) + 2 (r-1) at the boundary.
  const BendingSet set(make_grid({1.0, 1.0, 5, 4}), 1.0);
  EXPECT_EQ(set.name(), "bending");
  EXPECT_EQ(set.size(), 3 * 12 + 7 - 14);
  TriangleMesh one;
  one.vertices = Eigen::Matrix3d::Identity();
  one.triangles.resize(3, 1);
  one.triangles << 0, 1, 2;
  EXPECT_EQ(BendingSet(one, 1.0).size(), 0);
}

TEST(BendingSet, AffineMapsOfTheRestStateCostNothing) {
  Random random(3);
  TriangleMesh mesh = make_grid({1.0, 0.7, 6, 5});
  mesh.vertices.topRows(2) += random.positions(30, 0.03).topRows(2);
  const BendingSet set(mesh, 2.0);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix3d map;
    for (int k = 0; k < 3; ++k) map.col(k) = random.vector(2.0);
    const Positions x = (map * mesh.vertices).colwise() + random.vector(5.0);
    Forces f = Forces::Zero(3, 30);
    set.add_forces(x, f);
    // Weights of about 10 N/m times sums that cancel to 1e-15 of 10 m.
    EXPECT_LE(f.norm(), 1e-8);
    EXPECT_LE(set.energy(x), 1e-18);
  }
}

/// Energy of a grid's plate that is bent to z = (p x² + q y²)/2 + r x y: all of the plate's.
TEST(BendingSet, OfAGridIsTheOrthotropicPlate) {
  const GridOptions grid{1.0, 0.6, 11, 7};
  const double warp = 3e-3, weft = 1e-3;
  const BendingSet set(grid, warp, weft);
  Positions x = make_grid(grid).vertices;
  const double p = 0.03, q = -0.02, r = 0.05;
  x.row(2) = 0.5 * p * x.row(0).array().square() + 0.5 * q * x.row(1).array().square() +
             r * x.row(0).array() * x.row(1).array();
  const double expected =
      0.6 * (0.5 * warp * p * p + 0.5 * weft * q * q + std::sqrt(warp * weft) * r * r);
  EXPECT_NEAR(set.energy(x), expected, 1e-12 * expected);
  Random random(4);
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::Matrix3d map;
    for (int k = 0; k < 3; ++k) map.col(k) = random.vector(2.0);
    const Positions moved = (map * make_grid(grid).vertices).colwise() + random.vector(5.0);
    EXPECT_LE(set.energy(moved), 1e-18);
  }
}

TEST(BendingSet, OfATubeThatWasSewnKeepsTheFlatStatesEnergy) {
  // 1/2 B A / R², to the second order of the cells.
  const double radius = 0.1, stiffness = 2e-4;
  double errors[2];
  for (int k = 0; k < 2; ++k) {
    const TriangleMesh mesh = make_tube({radius, 0.3, 24 << k, 12 << k});
    const double plate = 0.5 * stiffness * 2.0 * M_PI * 0.3 / radius;
    errors[k] = std::abs(BendingSet(mesh, stiffness).energy(mesh.vertices) / plate - 1.0);
  }
  EXPECT_LE(errors[0], 0.02);
  EXPECT_LE(errors[1], 0.3 * errors[0]);
}

TEST(BendingSet, BendsAMeshsWarpAndWeftByTheirOwnStiffness) {
  const double warp = 4e-3, weft = 1e-3;
  const TriangleMesh mesh = make_grid({1.0, 1.0, 41, 41});
  const BendingSet along_x(mesh, {1.0, 0.0, 0.0}, warp, weft);
  const BendingSet along_y(mesh, {0.0, 5.0, 0.3}, warp, weft);
  Positions x = mesh.vertices, y = mesh.vertices;
  x.row(2) = 0.01 * x.row(0).array().square();
  y.row(2) = 0.01 * y.row(1).array().square();
  EXPECT_NEAR(along_x.energy(x) / along_x.energy(y), 4.0, 1e-9);
  EXPECT_NEAR(along_y.energy(y) / along_y.energy(x), 4.0, 1e-9);
  EXPECT_NEAR(along_x.energy(x), along_y.energy(y), 1e-12 * along_x.energy(x));
}

/// A 1 m strip rolled onto a cylinder of radius `radius` about y, keeping lengths.
Positions rolled(const TriangleMesh& flat, double radius) {
  Positions x = flat.vertices;
  for (int i = 0; i < x.cols(); ++i) {
    const double angle = flat.vertices(0, i) / radius;
    x.col(i) << radius * std::sin(angle), flat.vertices(1, i), radius * (1.0 - std::cos(angle));
  }
  return x;
}

/// Energy of the strip less the plate's 1/2 B kappa² A, over the latter.
double relative_error(int cells, double radius) {
  const double stiffness = 2e-3;
  const TriangleMesh mesh = make_grid({1.0, 0.5, cells + 1, cells / 2 + 1});
  const double plate = 0.5 * stiffness * 0.5 / (radius * radius);
  return BendingSet(mesh, stiffness).energy(rolled(mesh, radius)) / plate - 1.0;
}

TEST(BendingSet, ARolledGridHasThePlatesEnergy) {
  // The hinges between columns of cells carry the curvature: n - 1 of them on n columns, so a share
  // 1/n is missing at the ends; the chords' own error is of the order (h / R)², 1e-3 at 20 cells.
  for (const int cells : {20, 40, 80}) {
    EXPECT_NEAR(relative_error(cells, 1.0), -1.0 / cells, 1.0 / (cells * cells)) << cells;
  }
}

TEST(BendingSet, EnergyFallsWithTheSquareOfTheRadius) {
  const TriangleMesh mesh = make_grid({1.0, 0.5, 41, 21});
  const BendingSet set(mesh, 2e-3);
  // Curvature of chords instead of arcs: (h / R)² / 12, 1e-4 at R = 0.5 m.
  EXPECT_NEAR(set.energy(rolled(mesh, 0.5)) / set.energy(rolled(mesh, 1.0)), 4.0, 4e-3);
}

TEST(BendingSet, RefusesBadStiffness) {
  const TriangleMesh mesh = make_grid({1.0, 1.0, 3, 3});
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { BendingSet(mesh, bad); }, {"bending stiffness", "N m", "positive"});
  }
}

}  // namespace
}  // namespace pliant
