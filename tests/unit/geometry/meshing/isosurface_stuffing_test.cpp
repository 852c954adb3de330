#include "pliant/geometry/meshing/isosurface_stuffing.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "pliant/geometry/mesh/dihedral_angles.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "support/random.h"

namespace pliant {
namespace {

/// Samples that call `distance` within and are positive on the four outer layers.
template <typename Distance>
DistanceGrid grid_of(int count, const Distance& distance) {
  DistanceGrid grid;
  grid.origin = Eigen::Vector3d(1.0, 2.0, 3.0);
  grid.spacing = 0.5;
  grid.count.setConstant(count);
  for (int z = 0; z < count; ++z) {
    for (int y = 0; y < count; ++y) {
      for (int x = 0; x < count; ++x) {
        const Eigen::Array3i at(x, y, z);
        const bool is_outer = at.minCoeff() < 4 || at.maxCoeff() >= count - 4;
        grid.samples.push_back(is_outer ? 1.0f : static_cast<float>(distance(at)));
      }
    }
  }
  return grid;
}

/// A distance whose cut points lie just within and just beyond the shares of an edge at which
/// lattice points move: where the angles are worst.
double near_the_limits(Random& random, double sign) {
  constexpr double kShort = 0.39 / 0.61, kLong = 0.25 / 0.75;
  const double sizes[] = {1.0,           1.001 * kShort, 0.999 * kShort,  1.001 * kLong,
                          0.999 * kLong, kShort * kLong, kShort * kShort, 0.01};
  return sign * sizes[static_cast<int>(random(0, 8))];
}

TEST(IsosurfaceStuffing, KeepsItsAnglesInNoise) {
  // Every stencil and every warp: each sample's sign and size is drawn by itself.
  Random random(11);
  AngleRange worst{180.0, 0.0};
  for (int round = 0; round < 60; ++round) {
    const double share = random(-0.9, -0.2);  // most samples are inside
    const DistanceGrid grid = grid_of(26, [&](const Eigen::Array3i&) {
      const double any = random(-1.0, 1.0) + share;
      return round % 2 == 0 ? any : near_the_limits(random, any < 0.0 ? -1.0 : 1.0);
    });
    const TetrahedralMesh mesh = stuff_negative(grid);
    EXPECT_NO_THROW(validate(mesh, "noise"));
    const AngleRange angles = dihedral_angles(mesh);
    worst.least = std::min(worst.least, angles.least);
    worst.greatest = std::max(worst.greatest, angles.greatest);
  }
  EXPECT_GE(worst.least, kStuffingLeastAngle);
  EXPECT_LE(worst.greatest, kStuffingGreatestAngle);
  // Noise comes near the bounds: they are those of the method, not of tame surfaces.
  EXPECT_LT(worst.least, kStuffingLeastAngle + 2.0);
  EXPECT_GT(worst.greatest, kStuffingGreatestAngle - 5.0);
}

TEST(IsosurfaceStuffing, FacesOfABoxAreWhereTheyBelong) {
  // Planes are linear, and so is the interpolation.
  const DistanceGrid grid =
      grid_of(30, [](const Eigen::Array3i& at) { return (at - 15).abs().maxCoeff() - 6.5; });
  const TetrahedralMesh mesh = stuff_negative(grid);
  EXPECT_NO_THROW(validate(mesh, "box"));
  const Eigen::Array3d lowest = mesh.vertices.rowwise().minCoeff();
  const Eigen::Array3d highest = mesh.vertices.rowwise().maxCoeff();
  EXPECT_TRUE((highest - lowest <= 13.0 * 0.5 + 1e-12).all());
  EXPECT_TRUE((highest - lowest >= 12.9 * 0.5).all());
}

TEST(IsosurfaceStuffing, NothingInsideGivesNothing) {
  const TetrahedralMesh mesh =
      stuff_negative(grid_of(12, [](const Eigen::Array3i&) { return 1.0; }));
  EXPECT_EQ(mesh.tetrahedra.cols(), 0);
}

}  // namespace
}  // namespace pliant
