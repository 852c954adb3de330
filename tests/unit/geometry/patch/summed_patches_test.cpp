// The paper's own form of patches: what it fits, and what stands open between them.
#include "pliant/geometry/patch/summed_patches.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/meshing/simplify.h"
#include "support/expect_refusal.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

TEST(SummedPatches, OneQuadricATriangleIsTheWholeSphere) {
  const TriangleMesh sphere = icosphere(4), base = icosphere(0);
  const SummedPatches body = fit_summed_patches(base, samples_of(sphere, base), 1);
  for (int t = 0; t < base.triangles.cols(); ++t) {
    ASSERT_EQ(body.quadrics[static_cast<std::size_t>(t)].size(), 1u) << t;
    for (const Eigen::Vector3d& at : {Eigen::Vector3d(0.4, 0.3, 0.3), Eigen::Vector3d(0.5, 0.5, 0),
                                      Eigen::Vector3d(0.8, 0.1, 0.1)}) {
      const Eigen::Vector3d p = point(body, t, at);
      EXPECT_NEAR(p.norm(), 1.0, 2e-3) << t;
      EXPECT_GT(value(body, t, 0.99 * p), 0.0) << "inside";
      EXPECT_LT(value(body, t, 1.01 * p), 0.0) << "outside";
    }
  }
}

TEST(SummedPatches, PerpendicularClippingPlanesLeaveAGapAtAConvexEdge) {
  const TriangleMesh sphere = icosphere(4), base = icosphere(0);
  const SummedReport report =
      compare(fit_summed_patches(base, samples_of(sphere, base), 1), sphere);
  // From the middle m of an icosahedron's edge along the normals of both faces to the sphere.
  const double to_face = 0.794654, to_edge = 0.850651;
  const double rise = std::sqrt(to_face * to_face + 1.0 - to_edge * to_edge) - to_face;
  const double between_normals = 2.0 * std::sin(0.5 * std::acos(std::sqrt(5.0) / 3.0));
  EXPECT_NEAR(report.widest_gap, rise * between_normals, 0.02 * rise * between_normals);
  EXPECT_GT(report.rms_gap, 0.5 * report.widest_gap);
  EXPECT_EQ(report.quadrics, 20);
}

TEST(SummedPatches, MoreQuadricsAreNearerToWhatOneCannotBe) {
  const TriangleMesh torus = torus_surface(1.0, 0.4, 120, 60);
  const TriangleMesh base = simplify(torus, 100);
  const std::vector<FitSample> samples = samples_of(torus, base);
  const SummedReport one = compare(fit_summed_patches(base, samples, 1), torus);
  const SummedReport three = compare(fit_summed_patches(base, samples, 3), torus);
  EXPECT_LT(three.rms_distance, 0.9 * one.rms_distance);
  EXPECT_GT(three.quadrics, one.quadrics);
  EXPECT_LE(three.quadrics, 300);
}

TEST(SummedPatches, WhatLiesBelowTheBaseMovesItInwards) {
  // The inner side of a torus is a saddle: its samples lie on both sides of the triangles.
  const TriangleMesh torus = torus_surface(1.0, 0.4, 120, 60);
  const TriangleMesh base = simplify(torus, 320);
  const SummedPatches body = fit_summed_patches(base, samples_of(torus, base), 1);
  EXPECT_LT(signed_volume(body.base), signed_volume(base));
  EXPECT_EQ(body.base.triangles, base.triangles);
}

TEST(SummedPatches, NumbersOutOfRangeAreRefused) {
  const TriangleMesh base = icosphere(0);
  const std::vector<FitSample> samples = samples_of(icosphere(2), base);
  for (const int each : {0, -1, kMostPerturbations + 1}) {
    expect_refusal([&] { fit_summed_patches(base, samples, each); },
                   {"quadrics a patch are", "[1, 8]"});
  }
}

}  // namespace
}  // namespace pliant
