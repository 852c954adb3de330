#include "pliant/geometry/patch/patch_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "pliant/geometry/patch/patch_shapes.h"
#include "support/expect_refusal.h"
#include "support/worlds/patch_bodies.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

Vector3d barycentric(Random& random) {
  const Vector3d at(random(0, 1), random(0, 1), random(0, 1));
  return at / at.sum();
}

Vector3d base_point(const PatchBody& body, int patch, const Vector3d& at) {
  Vector3d p = Vector3d::Zero();
  for (int k = 0; k < 3; ++k) p += at[k] * body.base.vertices.col(body.base.triangles(k, patch));
  return p;
}

class Patches : public testing::TestWithParam<bool> {
 protected:
  PatchSurface surface() const {
    PatchBody body = three_patches();
    body.dents = GetParam();
    return PatchSurface(body);
  }
};

TEST_P(Patches, GradientIsThatOfTheValue) {
  const PatchSurface s = surface();
  Random random(3);
  for (int round = 0; round < 300; ++round) {
    const int patch = round % s.patches();
    const Vector3d p = base_point(s.body(), patch, barycentric(random)) + random.vector(0.2);
    const Vector3d offset = random.vector(1.0);
    // Central differences at two widths; Richardson leaves h^4 of the fifth derivative.
    const auto difference = [&](double h) {
      return (s.value(patch, p + h * offset) - s.value(patch, p - h * offset)) / (2.0 * h);
    };
    const double h = 1e-3;
    const double slope = (4.0 * difference(h) - difference(2.0 * h)) / 3.0;
    EXPECT_NEAR(s.gradient(patch, p).dot(offset), slope, 1e-6 * (1.0 + std::abs(slope)));
  }
}

TEST_P(Patches, PointsLieOnTheSurfaceAndSeparateInsideFromOutside) {
  const PatchSurface s = surface();
  Random random(4);
  for (int round = 0; round < 300; ++round) {
    const int patch = round % s.patches();
    const Vector3d p = s.point(patch, barycentric(random));
    const Vector3d out = s.normal(patch, p);
    EXPECT_NEAR(out.norm(), 1.0, 1e-14);
    EXPECT_NEAR(s.value(patch, p), 0.0, 1e-12 * (1.0 + s.gradient(patch, p).norm()));
    EXPECT_LT(s.value(patch, p + 1e-6 * out), 0.0);
    EXPECT_GT(s.value(patch, p - 1e-6 * out), 0.0);
  }
}

TEST_P(Patches, NeighboursMeetOnTheirEdgeInPointAndValue) {
  const PatchSurface s = surface();
  const Eigen::Matrix3Xi& t = s.body().base.triangles;
  for (int patch = 0; patch < 3; ++patch) {
    const int next = (patch + 1) % 3;
    ASSERT_EQ(t(2, patch), t(1, next));
    for (int i = 0; i <= 50; ++i) {
      const double at = i / 50.0;
      const Vector3d mine = s.point(patch, {1.0 - at, 0.0, at});
      const Vector3d others = s.point(next, {1.0 - at, at, 0.0});
      EXPECT_LE((mine - others).norm(), 1e-13);
      EXPECT_NEAR(s.value(patch, mine), s.value(next, mine), 1e-13);
    }
  }
}

TEST_P(Patches, BulgesAndOnlyThenDents) {
  const PatchSurface s = surface();
  Random random(5);
  double highest = 0.0, lowest = 0.0;
  for (int round = 0; round < 2000; ++round) {
    const Vector3d at = barycentric(random);
    const Vector3d p = s.point(0, at);
    const auto& x = s.body().base.vertices;
    const Vector3d a = x.col(0), b = x.col(1), c = x.col(2);
    const double height = (b - a).cross(c - a).normalized().dot(p - a);
    highest = std::max(highest, height);
    lowest = std::min(lowest, height);
  }
  EXPECT_GT(highest, 0.1);
  if (!GetParam()) {
    EXPECT_GE(lowest, -1e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutDents, Patches, testing::Bool());

TEST(PatchSurface, AFlatEdgeHasThePapersPerpendicularPlane) {
  PatchBody body;
  body.base.vertices.resize(3, 4);
  body.base.vertices << 0, 1, 1, 0,  //
      0, 0, 1, 1,                    //
      0, 0, 0, 0;
  body.base.triangles.resize(3, 2);
  body.base.triangles << 0, 0,  //
      1, 2,                     //
      2, 3;
  body.edges = edges(body.base).vertices;
  body.quadrics.assign(5, Quadric::Zero());
  // A bulge in the first triangle alone: Q = 2 (ball about its centroid), positive within 0.2.
  body.dents = false;
  Quadric ball = Quadric::Zero();
  ball.head<3>().setConstant(-1.0);
  ball[9] = 1.0;
  for (Quadric& q : body.quadrics) q = 0.5 * placed(ball, {2.0 / 3.0, 1.0 / 3.0, 0.0}, 0.2);
  const PatchSurface s(body);
  // F' = -z + (0.5 (1 - z²/0.04))³ over the centroid.
  const Vector3d top = s.point(0, {1.0 / 3, 1.0 / 3, 1.0 / 3});
  EXPECT_NEAR(top[2], std::pow(0.5 * (1.0 - top[2] * top[2] / 0.04), 3), 1e-14);
  EXPECT_NEAR(top[0], 2.0 / 3.0, 1e-14);
  EXPECT_TRUE(s.contains(0, {0.6, 0.3, -1e-3}));
  EXPECT_FALSE(s.contains(1, {0.6, 0.3, -1e-3}));
  EXPECT_FALSE(s.contains(0, {0.6, 0.3, 0.5}));
  EXPECT_TRUE(s.contains(0, {2.0 / 3.0, 1.0 / 3.0, 0.99 * top[2]}));
  EXPECT_FALSE(s.contains(0, {2.0 / 3.0, 1.0 / 3.0, 1.01 * top[2]}));
}

TEST(PatchSurface, SteepQuadricsAreTheShape) {
  // Q = k (1 - r²)/2 and F' = 0 give Q³ = h: off the sphere by about cbrt(h) / k.
  const TriangleMesh base = icosphere(0);
  for (const double steepness : {1e3, 1e5}) {
    const PatchSurface s(sphere_patches(base, steepness));
    Random random(6);
    for (int round = 0; round < 200; ++round) {
      const Vector3d p = s.point(round % 20, barycentric(random));
      EXPECT_NEAR(p.norm(), 1.0, 1.0 / steepness);
      EXPECT_TRUE(s.inside(0.9999 * (1.0 - 2.0 / steepness) * p));
      EXPECT_FALSE(s.inside((1.0001 + 2.0 / steepness) * p));
    }
    EXPECT_TRUE(s.inside({0.0, 0.0, 0.0}));
    EXPECT_FALSE(s.inside({9.0, 0.0, 0.0}));
  }
}

TEST(PatchSurface, InsideOfATorusIsWhatItsFormulaSays) {
  const PatchSurface s(make_torus_patches(1.0, 0.4, 32, 16));
  constexpr double kFitError = 3e-3;  // greatest distance of that fit from the torus
  Random random(9);
  int within = 0, near = 0;
  for (int round = 0; round < 5000; ++round) {
    const Vector3d p(random(-1.5, 1.5), random(-1.5, 1.5), random(-0.5, 0.5));
    const double distance = std::hypot(std::hypot(p[0], p[1]) - 1.0, p[2]) - 0.4;
    near += std::abs(distance) < 0.02 ? 1 : 0;
    if (std::abs(distance) < kFitError) continue;
    EXPECT_EQ(s.inside(p), distance < 0.0) << p.transpose() << ": " << distance;
    within += distance < 0.0 ? 1 : 0;
  }
  EXPECT_GT(within, 500);
  EXPECT_GT(near, 100);
}

TEST(PatchSurface, NormalsCrossSteepEdgesWithoutAKink) {
  const PatchSurface s(sphere_patches(icosphere(0), 1e5));
  for (int patch = 0; patch < s.patches(); ++patch) {
    for (const double at : {0.2, 0.5, 0.8}) {
      const Vector3d p = s.point(patch, {0.0, at, 1.0 - at});
      // The base's normal weighs 1 against 3 Q² |grad Q| = 3 h^(2/3) k > 1e4.
      EXPECT_LT((s.normal(patch, p) - p.normalized()).norm(), 1e-4);
    }
  }
}

TEST(PatchSurface, BadBodiesAreRefused) {
  const auto refuse = [](const PatchBody& body, const std::vector<std::string>& parts) {
    expect_refusal([&] { PatchSurface(body, "ball.yaml"); }, parts);
  };
  PatchBody body = sphere_patches(icosphere(0), 10.0);
  body.quadrics.pop_back();
  refuse(body, {"ball.yaml: 29 quadrics for 30 edges"});
  body = sphere_patches(icosphere(0), 10.0);
  body.quadrics[7][3] = std::numeric_limits<double>::quiet_NaN();
  refuse(body, {"1 edges have a quadric that is not finite: 7"});
  body = sphere_patches(icosphere(0), 10.0);
  body.quadrics[7][9] += 1.0;
  refuse(body, {"1 edges have a quadric that lifts the surface", ": 7"});
  body = sphere_patches(icosphere(0), 10.0);
  body.base.vertices(0, 0) = std::numeric_limits<double>::infinity();
  refuse(body, {"vertices are not finite: 0"});
  body = sphere_patches(icosphere(0), 10.0);
  body.base.triangles.resize(3, 0);
  refuse(body, {"no triangles"});
  PatchBody folded = three_patches();
  folded.base.vertices.col(3) = folded.base.vertices.col(1) + Vector3d(0.0, 0.1, 0.0);
  folded.base.triangles.conservativeResize(3, 2);
  folded.edges = edges(folded.base).vertices;
  folded.quadrics.assign(folded.edges.size(), Quadric::Zero());
  refuse(folded, {"fold back"});
}

TEST(PatchSurface, BodiesWithoutInsideAreRefused) {
  expect_refusal([] { validate_solid(three_patches(), "figure"); },
                 {"figure: the body is open, 3 edges"});
  PatchBody body = sphere_patches(icosphere(0), 10.0);
  EXPECT_NO_THROW(validate_solid(body, "ball"));
  body.base.triangles.row(1).swap(body.base.triangles.row(2));
  body.edges = edges(body.base).vertices;
  expect_refusal([&] { validate_solid(body, "ball"); },
                 {"ball: the body is inside out", "reverse"});
}

}  // namespace
}  // namespace pliant
