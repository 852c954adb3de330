// Springs against the membrane whose stiffness per width they stand for, on homogeneous strains.
#include "pliant/models/cloth/cloth_springs.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

const GridOptions kSpringsGrid{0.6, 0.4, 7, 9};
const double kArea = 0.24;
const FabricStiffness kStiffness{300.0, 200.0, 50.0};

double energy(const std::vector<Spring>& springs, const Positions& x) {
  return SpringSet("springs", springs, static_cast<int>(x.cols())).energy(x);
}

Positions strained(const TriangleMesh& mesh, const Eigen::Matrix3d& map) {
  return map * mesh.vertices;
}

/// Stretch by `x` and `y`, shear by the angle `gamma`.
Eigen::Matrix3d deformation(double x, double y, double gamma) {
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map(0, 0) += x;
  map(1, 1) += y;
  map(0, 1) = map(1, 0) = 0.5 * gamma;
  return map;
}

TEST(GridStretch, EnergyOfAStretchedPatchIsTheMembranes) {
  const auto springs = grid_stretch_springs(kSpringsGrid, kStiffness);
  const TriangleMesh mesh = make_grid(kSpringsGrid);
  for (const double strain : {0.1, -0.1, 0.01}) {
    // 1/2 K eps² A, exactly: the springs lie along the strain.
    EXPECT_NEAR(energy(springs, strained(mesh, deformation(strain, 0, 0))),
                0.5 * kStiffness.warp * strain * strain * kArea, 1e-13);
    EXPECT_NEAR(energy(springs, strained(mesh, deformation(0, strain, 0))),
                0.5 * kStiffness.weft * strain * strain * kArea, 1e-13);
  }
}

TEST(GridStretch, ForceOnAnEdgeIsStiffnessTimesWidthTimesStrain) {
  const TriangleMesh mesh = make_grid(kSpringsGrid);
  const SpringSet set("stretch", grid_stretch_springs(kSpringsGrid, kStiffness),
                      static_cast<int>(mesh.vertices.cols()));
  Forces f = Forces::Zero(3, mesh.vertices.cols());
  set.add_forces(strained(mesh, deformation(0.02, 0, 0)), f);
  double left = 0.0;
  for (int row = 0; row < kSpringsGrid.rows; ++row) left += f(0, row * kSpringsGrid.columns);
  EXPECT_NEAR(left, kStiffness.warp * kSpringsGrid.height * 0.02, 1e-12);
}

TEST(GridStretch, ADirectionWithoutStiffnessHasNoSprings) {
  EXPECT_EQ(grid_stretch_springs(kSpringsGrid, {1.0, 0.0, 0.0}).size(), 6u * 9u);
  EXPECT_EQ(grid_stretch_springs(kSpringsGrid, {0.0, 1.0, 0.0}).size(), 7u * 8u);
  EXPECT_TRUE(grid_stretch_springs(kSpringsGrid, {0.0, 0.0, 0.0}).empty());
}

class GridShear : public testing::TestWithParam<int> {};

TEST_P(GridShear, EnergyOfAShearedPatchIsTheMembranes) {
  const auto springs = grid_shear_springs(kSpringsGrid, kStiffness.shear, GetParam());
  const TriangleMesh mesh = make_grid(kSpringsGrid);
  EXPECT_EQ(springs.size(), 48u * static_cast<unsigned>(GetParam()));
  for (const double gamma : {1e-3, 1e-4}) {
    const double membrane = 0.5 * kStiffness.shear * gamma * gamma * kArea;
    const double stored = energy(springs, strained(mesh, deformation(0, 0, gamma)));
    // Linear springs against linear strain: relative error of the order of gamma.
    EXPECT_NEAR(stored / membrane, 1.0, 2.0 * gamma);
  }
}

INSTANTIATE_TEST_SUITE_P(Diagonals, GridShear, testing::Values(1, 2));

TEST(GridShearSprings, WithoutStiffnessThereAreNone) {
  EXPECT_TRUE(grid_shear_springs(kSpringsGrid, 0.0, 2).empty());
}

}  // namespace
}  // namespace pliant
