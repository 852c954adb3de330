#include "pliant/elements/cloth/cell_shear_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/models/cloth/cloth_springs.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

const GridOptions kCellGrid{0.6, 0.3, 5, 7};
constexpr double kShear = 40.0, kCellArea = 0.18;

CellShearSet cell_shear() {
  return CellShearSet(grid_shear_cells(kCellGrid, kShear), kCellGrid.columns * kCellGrid.rows);
}

Eigen::Matrix3d simple_shear(double gamma) {
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(0, 1) = gamma;
  return map;
}

TEST(CellShearSet, StretchAlongTheSidesCostsNothing) {
  const CellShearSet set = cell_shear();
  const Positions rest = make_grid(kCellGrid).vertices;
  Random random(4);
  for (const double x : {0.5, 0.9, 1.3}) {
    const Eigen::Matrix3d turn = random.rotation();
    const Positions moved = turn * Eigen::Vector3d(x, 1.7, 1.0).asDiagonal() * rest;
    EXPECT_LE(set.energy(moved), 1e-28) << x;
    EXPECT_LE(forces_of(set, moved).norm(), 1e-12) << x;
  }
}

TEST(CellShearSet, ShearCostsWhatTheFabricDoes) {
  const CellShearSet set = cell_shear();
  const Positions rest = make_grid(kCellGrid).vertices;
  for (const double gamma : {1e-2, 1e-4, -1e-2}) {
    // Equal for both signs, hence of second order in the angle.
    const double membrane = 0.5 * kShear * gamma * gamma * kCellArea;
    EXPECT_NEAR(set.energy(simple_shear(gamma) * rest) / membrane, 1.0, gamma * gamma) << gamma;
  }
}

TEST(CellShearSet, DiagonalsWithoutLengthStayFinite) {
  CellShearSet set({{{0, 1, 2, 3}, 10.0}}, 4);
  Positions x = Positions::Zero(3, 4);
  EXPECT_EQ(set.energy(x), 0.0);
  EXPECT_TRUE(forces_of(set, x).isZero(0.0));
  x.col(1) << 1.0, 0.0, 0.0;
  EXPECT_NEAR(set.energy(x), 5.0, 1e-12);
  set.relax(Eigen::VectorXd::Ones(4), 0.1, x);
  EXPECT_TRUE(x.allFinite());
  EXPECT_TRUE(forces_of(set, x).allFinite());
}

TEST(CellShearSet, RefusesBadCells) {
  const auto expect_refused = [](const ShearCell& cell) {
    expect_refusal(
        [&] {
          CellShearSet({{{0, 1, 2, 3}, 1.0}, cell}, 4);
        },
        {"shear cell 1", "four different particles", "positive stiffness"});
  };
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refused({{0, 1, 2, 3}, bad});
  }
  expect_refused({{0, 1, 2, 4}, 1.0});
  expect_refused({{0, -1, 2, 3}, 1.0});
  expect_refused({{0, 1, 2, 1}, 1.0});
}

}  // namespace
}  // namespace pliant
