#include "pliant/study/experiments/cloth_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {
namespace {

const GridOptions kGrid{0.3, 0.3, 61, 61};

/// A cone with `ridges` folds, the first in the direction `turn` [rad].
Positions cone(int ridges, double turn) {
  Positions x = make_grid(kGrid).vertices;
  for (auto p : x.colwise()) {
    const double angle = std::atan2(p.y(), p.x()) - turn;
    p.z() = 0.1 - 0.5 * p.head<2>().norm() * (1.0 - 0.2 * std::cos(ridges * angle));
  }
  return x;
}

TEST(ClothShape, FindsFoldsAndTheirDirections) {
  for (const int ridges : {2, 4, 5}) {
    const Folds folds = find_folds(kGrid, cone(ridges, 0.2), {0, 0}, 0.05);
    ASSERT_EQ(folds.directions.size(), static_cast<std::size_t>(ridges));
    for (int k = 0; k < ridges; ++k) {
      // Cells of 5 mm on a circle of 5 cm blur them by a tenth.
      const double wanted = 0.2 * 180.0 / M_PI + 360.0 / ridges * k;
      EXPECT_NEAR(folds.directions[static_cast<std::size_t>(k)], wanted, 6.0);
    }
  }
}

TEST(ClothShape, ALevelCircleHasNoFolds) {
  EXPECT_TRUE(find_folds(kGrid, cone(0, 0.0), {0, 0}, 0.05).directions.empty());
}

TEST(ClothShape, HeightsAreThoseOfTheSurface) {
  Positions x = make_grid(kGrid).vertices;
  for (auto p : x.colwise()) p.z() = 0.2 + p.x() - 0.5 * p.y();
  EXPECT_NEAR(height_at(kGrid, x, {0.0123, -0.0456}), 0.2 + 0.0123 + 0.0228, 1e-12);
  EXPECT_EQ(height_at(kGrid, x, {1.0, 0.0}), 0.0);
}

TEST(ClothShape, WettedRadiusIsThatOfTheLiftedArea) {
  const TriangleMesh mesh = make_grid(kGrid);
  Positions x = mesh.vertices;
  for (auto p : x.colwise()) p.z() = p.head<2>().norm() < 0.1 ? 0.01 : 0.0;
  EXPECT_NEAR(wetted_radius(vertex_areas(mesh), x, 0.001), 0.1, 0.005);
}

}  // namespace
}  // namespace pliant
