#include "pliant/geometry/meshing/quadric.h"

#include <gtest/gtest.h>

#include "pliant/geometry/mesh/display_surface.h"
#include "pliant/geometry/patch/patch_fit.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

Quadric any(Random& random) {
  Quadric q;
  for (int k = 0; k < 10; ++k) q[k] = random(-1, 1);
  return q;
}

TEST(Quadric, GradientIsThatOfTheValue) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const Quadric q = any(random);
    const Eigen::Vector3d p = random.vector(2.0), offset = random.vector(1.0);
    // A quadric's central difference is exact but for round-off.
    const double slope = 0.5 * (value(q, p + offset) - value(q, p - offset));
    EXPECT_NEAR(gradient(q, p).dot(offset), slope, 1e-13);
  }
}

TEST(Quadric, IsMovedAndScaled) {
  Random random(2);
  for (int round = 0; round < 50; ++round) {
    const Quadric q = any(random);
    const Eigen::Vector3d origin = random.vector(3.0), p = random.vector(3.0);
    EXPECT_NEAR(value(placed(q, origin, 0.5), p), value(q, (p - origin) / 0.5), 1e-11);
  }
}

/// Points in all triangles of a base, with the triangle's normal.
std::vector<FitSample> samples_in_triangles(const TriangleMesh& base) {
  constexpr int kCuts = 6;
  std::vector<FitSample> samples;
  for (int t = 0; t < base.triangles.cols(); ++t) {
    const Eigen::Vector3d a = base.vertices.col(base.triangles(0, t));
    const Eigen::Vector3d b = base.vertices.col(base.triangles(1, t)) - a;
    const Eigen::Vector3d c = base.vertices.col(base.triangles(2, t)) - a;
    for (int i = 1; i < kCuts; ++i) {
      for (int j = 1; i + j < kCuts; ++j) {
        samples.push_back({a + (i * b + j * c) / kCuts, b.cross(c).normalized(), t});
      }
    }
  }
  return samples;
}

// One quadric is the whole shape, and there is no edge that would fit better without.
TEST(QuadricFit, EveryEdgeOfASphereHasTheSpheresQuadric) {
  const TriangleMesh base = icosphere(1);
  std::vector<FitSample> samples = samples_in_triangles(base);
  for (FitSample& sample : samples) sample.normal = sample.point = sample.point.normalized();
  const PatchBody body = fit_quadrics(base, samples);
  ASSERT_EQ(body.quadrics.size(), 120u);
  for (const Quadric& quadric : body.quadrics) {
    ASSERT_GT(quadric.norm(), 0.0);
    const double slope = gradient(quadric, Eigen::Vector3d::UnitX()).norm();
    for (const FitSample& sample : samples) {
      EXPECT_LE(std::abs(value(quadric, sample.point)), 1e-4 * slope);
    }
    EXPECT_GT(value(quadric, Eigen::Vector3d::Zero()), 0.0) << "it is positive inside";
  }
}

// With normals that turn across its faces the fits are wild and become the planes that halve its
// angles; the samples lie in the triangles, which are left flat.
TEST(QuadricFit, EdgesOfABoxHaveNone) {
  const TriangleMesh base = box_surface({1.0, 0.5, 0.25});
  const PatchBody body = fit_quadrics(base, samples_of(base, base));
  ASSERT_EQ(body.quadrics.size(), 18u);
  for (const Quadric& quadric : body.quadrics) EXPECT_TRUE(quadric.isZero(0.0));
}

}  // namespace
}  // namespace pliant
