#include "pliant/geometry/patch/patch_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/geometry/patch/patch_shapes.h"
#include "support/expect_refusal.h"
#include "support/worlds/patch_bodies.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(PatchSamples, LieOnTheSurfaceWithItsNormals) {
  const PatchSamples samples = sample_points(PatchSurface(make_sphere_patches(2.0, 1)), 0.2);
  for (int i = 0; i < samples.points.cols(); ++i) {
    EXPECT_NEAR(samples.points.col(i).norm(), 2.0, 2e-4);
    // At the base's vertices too, where it is taken 1e-3 beside them: curvature makes that 1e-3
    // of a turn at most.
    EXPECT_LT((samples.normals.col(i) - samples.points.col(i) / 2.0).norm(), 1e-3);
  }
}

TEST(PatchSamples, CoverTheSurfaceEvenlyAndOnce) {
  const PatchSurface surface(make_capsule_patches(0.05, 0.3, 8, 2));  // long and short patches
  const double spacing = 0.01;
  const PatchSamples samples = sample_points(surface, spacing);
  const TriangleMesh fine = polygonise(surface, 24).mesh;
  for (const auto v : fine.vertices.colwise()) {
    const double nearest = (samples.points.colwise() - v).colwise().norm().minCoeff();
    EXPECT_LT(nearest, spacing);
  }
  double least = 1.0;
  for (int i = 0; i < samples.points.cols(); ++i) {
    for (int j = 0; j < i; ++j) {
      least = std::min(least, (samples.points.col(i) - samples.points.col(j)).norm());
    }
  }
  EXPECT_GE(least, 0.5 * spacing);
  // Discs of a quarter spacing about them do not overlap.
  const double disc = 3.14159265358979323846 / 16.0 * spacing * spacing;
  EXPECT_LT(static_cast<double>(samples.points.cols()), area(fine) / disc);
}

TEST(PatchSamples, ACoarseSpacingLeavesTheBasesVertices) {
  const PatchSurface surface(three_patches());
  const PatchSamples samples = sample_points(surface, 100.0);
  EXPECT_EQ(samples.points, surface.body().base.vertices);
}

TEST(PatchSamples, PlacesGiveTheirPoints) {
  const PatchSurface surface(three_patches());
  const PatchSamples samples = sample_points(surface, 0.1);
  for (int i = 0; i < samples.points.cols(); ++i) {
    EXPECT_EQ(surface.point(samples.patch[i], samples.barycentric.col(i)), samples.points.col(i));
    EXPECT_NEAR(samples.normals.col(i).norm(), 1.0, 1e-14);
  }
}

TEST(PatchSamples, BadSpacingsAreRefused) {
  const PatchSurface surface(three_patches());
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { sample_points(surface, bad); }, {"spacing is", "> 0"});
  }
  expect_refusal([&] { sample_points(surface, 1e-6); },
                 {"spacing 1e-06 m asks for about", "10000000"});
}

}  // namespace
}  // namespace pliant
