#include "pliant/geometry/patch/patch_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/math/pi.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// The largest distance of a body's points from the points at `radius` from core(p); checks that
/// the body is one and its polygons are closed.
template <typename Core>
double error(const PatchBody& body, double radius, const Core& core) {
  EXPECT_NO_THROW(validate_solid(body, "shape"));
  const PatchPolygons polygons = polygonise(PatchSurface(body), 10);
  EXPECT_NO_THROW(validate(polygons.mesh, "polygons"));
  EXPECT_TRUE(boundary_vertices(polygons.mesh).empty());
  double worst = 0.0;
  for (const auto v : polygons.mesh.vertices.colwise()) {
    const Vector3d p = v;
    worst = std::max(worst, std::abs((p - Vector3d(core(p))).norm() - radius));
  }
  return worst;
}

TEST(PatchShapes, OneQuadricIsASphere) {
  for (const double radius : {1e-3, 1.0, 1e3}) {
    for (const int level : {0, 1, 2}) {
      const PatchBody body = make_sphere_patches(radius, level);
      EXPECT_EQ(body.base.triangles.cols(), 20 << 2 * level);
      // The softness: 1e-4 of an edge, which is 1.05 radii and less, at a height of one edge.
      const double off = error(body, radius, [](const Vector3d&) { return Vector3d(0, 0, 0); });
      EXPECT_LT(off, 1.05e-4 * radius);
    }
  }
}

TEST(PatchShapes, ATorusConvergesWithTheCubeOfItsPatches) {
  double last = 0.0;
  for (const int across : {8, 16, 32}) {
    const PatchBody body = make_torus_patches(1.0, 0.4, 2 * across, across);
    const double off = error(body, 0.4, [](const Vector3d& p) {
      return Vector3d(Vector3d(p[0], p[1], 0.0).normalized());
    });
    // Far below the sagitta of the facets alone.
    EXPECT_LT(off, 0.1 * 0.4 * (1.0 - std::cos(kPi / across)));
    // A quadric misses third derivatives: an eighth for half the edges; some of it is lost where
    // patches blend.
    if (last > 0.0) {
      EXPECT_LT(off, last / 5.0);
    }
    last = off;
  }
}

TEST(PatchShapes, VolumeOfATorusConvergesAsTheSquareOfTheGrid) {
  const PatchSurface surface(make_torus_patches(1.0, 0.4, 32, 16));
  const double fine = signed_volume(polygonise(surface, 64).mesh);
  const double coarse = std::abs(signed_volume(polygonise(surface, 4).mesh) - fine);
  const double middle = std::abs(signed_volume(polygonise(surface, 8).mesh) - fine);
  EXPECT_NEAR(coarse / middle, 4.0, 0.3);
  // The fit's own part: below its RMS distance (1e-4) times the area over the volume.
  EXPECT_NEAR(fine / (2.0 * kPi * kPi * 0.16), 1.0, 1e-3);
}

TEST(PatchShapes, ACapsuleIsRoundAtItsEndsAndStraightBetween) {
  double last = 0.0;
  for (const int rings : {2, 4}) {
    const PatchBody body = make_capsule_patches(0.5, 1.0, 4 * rings, rings);
    EXPECT_EQ(body.base.triangles.cols(), 16 * rings * rings);
    const double off = error(body, 0.5, [](const Vector3d& p) {
      return Vector3d(0.0, 0.0, std::clamp(p[2], -0.5, 0.5));
    });
    EXPECT_LT(off, 0.2 * 0.5 * (1.0 - std::cos(kPi / (4 * rings))));
    if (last > 0.0) {
      EXPECT_LT(off, last);
    }
    last = off;
  }
}

TEST(PatchShapes, ARoundedBoxHasFlatFaces) {
  double last = 1.0;
  for (const int segments : {1, 2, 4}) {
    const PatchBody body = make_rounded_box_patches({1.0, 0.6, 0.4}, 0.1, segments);
    const Vector3d core(0.4, 0.2, 0.1);
    const double off = error(
        body, 0.1, [&](const Vector3d& p) { return Vector3d(p.cwiseMax(-core).cwiseMin(core)); });
    // One quadric an edge cannot be flat on one side and round on the other: the normal is off by a
    // part of a segment's turn there, so that this falls with the first power.
    EXPECT_LT(off, 0.1 * 0.1 / segments);
    EXPECT_LT(off, last);
    last = off;
    EXPECT_NEAR(body.base.vertices.row(0).maxCoeff(), 0.5, 1e-15);
  }
}

TEST(PatchShapes, SizesOutsideTheirRangeAreRefused) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { make_sphere_patches(bad); }, {"radius is", "> 0"});
    expect_refusal([&] { make_torus_patches(bad, 0.1); }, {"ring is"});
    expect_refusal([&] { make_torus_patches(1.0, bad); }, {"tube is"});
    expect_refusal([&] { make_capsule_patches(0.1, bad); }, {"length is"});
    expect_refusal([&] { make_rounded_box_patches({1, bad, 1}, 0.1); }, {"size is"});
  }
  expect_refusal([] { make_torus_patches(1.0, 1.0); }, {"tube is 1", "less than ring"});
  expect_refusal([] { make_sphere_patches(1.0, 5); }, {"level is 5", "[0, 4]"});
  expect_refusal([] { make_torus_patches(1.0, 0.1, 2); }, {"around is 2", "[3, 1000]"});
  expect_refusal([] { make_capsule_patches(1.0, 1.0, 8, 0); }, {"rings is 0"});
  expect_refusal([] { make_torus_patches(1.0, 0.5, 1000, 1000); },
                 {"around 1000 and across 1000", "2000000 patches", "100000"});
  expect_refusal([] { make_capsule_patches(1.0, 1.0, 1000, 1000); },
                 {"around 1000 and rings 1000", "4000000 patches"});
  expect_refusal(
      [] {
        make_rounded_box_patches({1, 1, 1}, 0.1, 100);
      },
      {"segments 100", "484812 patches"});
  expect_refusal(
      [] {
        make_rounded_box_patches({1, 1, 0.4}, 0.2);
      },
      {"radius is 0.2", "(0, 0.1998"});
}

}  // namespace
}  // namespace pliant
