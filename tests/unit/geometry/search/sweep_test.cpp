#include "pliant/geometry/search/sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

// Counts queries, and hides that the shape is convex where asked to.
class Watched final : public Shape {
 public:
  Watched(const Shape& shape, bool convex) : shape_(shape), convex_(convex) {}
  SurfacePoint query(const Vector3d& p) const override {
    ++queries;
    return shape_.query(p);
  }
  Eigen::AlignedBox3d bounds() const override { return shape_.bounds(); }
  TriangleMesh surface() const override { return shape_.surface(); }
  std::string name() const override { return shape_.name(); }
  bool convex() const override { return convex_; }
  mutable int queries = 0;

 private:
  const Shape& shape_;
  bool convex_;
};

TEST(Sweep, FindsTheTimeOfContact) {
  const SweepHit hit = sweep_point(Sphere(1.0), {3.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, 0.0);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.5, 1e-8);
  EXPECT_LT((hit.point - Vector3d(1.0, 0.0, 0.0)).norm(), 1e-8);
  EXPECT_LT((hit.normal - Vector3d::UnitX()).norm(), 1e-8);
}

TEST(Sweep, KeepsTheOffset) {
  const SweepHit hit = sweep_point(Plane(), {0.0, 0.0, 1.0}, {1.0, 0.0, -1.0}, 0.1);
  ASSERT_TRUE(hit.hit);
  EXPECT_NEAR(hit.time, 0.45, 1e-8);
  EXPECT_NEAR(hit.point.z(), 0.1, 1e-8);
  EXPECT_EQ(hit.normal, Vector3d::UnitZ());
}

TEST(Sweep, AStartInsideHitsAtOnce) {
  const SweepHit hit = sweep_point(Box(Vector3d::Ones()), {0.0, 0.0, 0.4}, {0.0, 0.0, 3.0}, 0.0);
  ASSERT_TRUE(hit.hit);
  EXPECT_EQ(hit.time, 0.0);
  EXPECT_EQ(hit.point, Vector3d(0.0, 0.0, 0.4));
  EXPECT_EQ(hit.normal, Vector3d::UnitZ());
  EXPECT_TRUE(sweep_point(Plane(), {0, 0, 0.05}, {0, 0, 1}, 0.1).hit);
  EXPECT_TRUE(sweep_point(Plane(), {0, 0, 0}, {0, 0, 0}, 0.0).hit);
}

TEST(Sweep, MissesWhatItPassesBy) {
  const Sphere sphere(1.0);
  EXPECT_FALSE(sweep_point(sphere, {-5.0, 1.0001, 0.0}, {5.0, 1.0001, 0.0}, 0.0).hit);
  EXPECT_TRUE(sweep_point(sphere, {-5.0, 0.9999, 0.0}, {5.0, 0.9999, 0.0}, 0.0).hit);
  EXPECT_TRUE(sweep_point(sphere, {-5.0, 1.0001, 0.0}, {5.0, 1.0001, 0.0}, 0.001).hit);
  const SweepHit miss = sweep_point(sphere, {2.0, 0.0, 0.0}, {1.5, 0.0, 0.0}, 0.0);
  EXPECT_FALSE(miss.hit);
  EXPECT_EQ(miss.time, 1.0);
  EXPECT_EQ(miss.point, Vector3d(1.5, 0.0, 0.0));
}

TEST(Sweep, SlidingAlongOrLeavingIsNoHit) {
  EXPECT_FALSE(sweep_point(Plane(), {0, 0, 1e-9}, {5, 0, 1e-9}, 0.0).hit);
  EXPECT_FALSE(sweep_point(Plane(), {0, 0, 1e-12}, {1, 0, 1}, 0.0).hit);
  EXPECT_FALSE(sweep_point(Plane(), {0, 0, 1}, {0, 0, 1}, 0.0).hit);
}

TEST(Sweep, NeverPassesThroughAThinWallHoweverFast) {
  const Box wall(Vector3d(1.0, 1.0, 1e-6));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-0.49, 0.49);
  for (const double speed : {1.0, 1e3, 1e6}) {
    for (int i = 0; i < 1000; ++i) {
      const Vector3d through(uniform(random), uniform(random), 0.0);
      const Vector3d displacement = speed * Vector3d(uniform(random), uniform(random), -1.0);
      const SweepHit hit =
          sweep_point(wall, through - 0.3 * displacement, through + 0.7 * displacement, 0.0);
      ASSERT_TRUE(hit.hit);
      EXPECT_NEAR(hit.time, 0.3, 1e-5);
      EXPECT_EQ(hit.normal, Vector3d::UnitZ());
    }
  }
}

TEST(Sweep, AgreesWithDenseSampling) {
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Sphere>(0.6));
  shapes.push_back(std::make_unique<Box>(Vector3d(1.0, 0.5, 0.3)));
  shapes.push_back(std::make_unique<Capsule>(0.3, 0.6));
  shapes.push_back(std::make_unique<Cylinder>(0.4, 0.5));
  shapes.push_back(std::make_unique<MeshShape>(Box(Vector3d(1.0, 0.5, 0.3)).surface()));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  constexpr int kSamples = 2000;
  for (const auto& shape : shapes) {
    const Watched general(*shape, false);
    for (int i = 0; i < 1000; ++i) {
      const Vector3d from(uniform(random), uniform(random), uniform(random));
      const Vector3d to(uniform(random), uniform(random), uniform(random));
      const double offset = 0.02 * (i % 3);
      double time = 2.0, least = 1e9;
      for (int s = 0; s <= kSamples && time > 1.0; ++s) {
        const double gap = shape->distance(from + double(s) / kSamples * (to - from)) - offset;
        least = std::min(least, gap);
        if (gap <= 0.0) time = double(s) / kSamples;
      }
      for (const Shape* tested : {static_cast<const Shape*>(shape.get()), (const Shape*)&general}) {
        const SweepHit hit = sweep_point(*tested, from, to, offset);
        if (time <= 1.0) {
          ASSERT_TRUE(hit.hit || time * kSamples + 0.5 > kSamples) << shape->name();
          EXPECT_LE(hit.time, time + 1e-6) << shape->name();
          EXPECT_GE(hit.time, time - 2.0 / kSamples) << shape->name();
        } else if (least > 2e-3) {
          EXPECT_FALSE(hit.hit) << shape->name() << " least gap " << least;
        }
        if (hit.hit && hit.time > 0.0) {
          EXPECT_NEAR(shape->distance(hit.point), offset, 1e-6) << shape->name();
        }
      }
    }
  }
}

TEST(Sweep, OneQueryWhereThePointCannotReach) {
  const Sphere sphere(1.0);
  for (const bool convex : {true, false}) {
    const Watched shape(sphere, convex);
    EXPECT_FALSE(sweep_point(shape, {5, 0, 0}, {4.9, 0, 0}, 0.0).hit);
    EXPECT_EQ(shape.queries, 1);
  }
}

TEST(Sweep, QueriesAreBounded) {
  const Box box(Vector3d::Ones());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int most_convex = 0, most_general = 0;
  for (int i = 0; i < 20000; ++i) {
    // Half of the paths graze the upper side.
    const double z = i % 2 ? 0.5 + 1e-7 * (1.0 + uniform(random)) : uniform(random);
    const Vector3d from(3.0 * uniform(random), 3.0 * uniform(random), z);
    const Vector3d to(3.0 * uniform(random), 3.0 * uniform(random), i % 2 ? z : uniform(random));
    const Watched convex(box, true), general(box, false);
    const SweepHit a = sweep_point(convex, from, to, 0.0);
    sweep_point(general, from, to, 0.0);
    EXPECT_TRUE(a.point.allFinite());
    most_convex = std::max(most_convex, convex.queries);
    most_general = std::max(most_general, general.queries);
  }
  EXPECT_LE(most_convex, 40);
  EXPECT_LE(most_general, 500);
}

TEST(Sweep, PositionsThatAreNotFiniteNeverHit) {
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf, 1e308}) {
    EXPECT_FALSE(sweep_point(Sphere(1.0), {bad, 0, 0}, {0, 0, 0}, 0.0).hit);
    EXPECT_FALSE(sweep_point(Sphere(1.0), {2, 0, 0}, {0, bad, 0}, 0.0).hit);
  }
  EXPECT_FALSE(sweep_point(Sphere(1.0), {2, 0, 0}, {0, 0, 0}, nan).hit);
}

TEST(Sweep, FastPointsHitAMesh) {
  const MeshShape shape(Sphere(0.5).surface());
  for (const double speed : {1.0, 1e3, 1e6}) {
    const Vector3d displacement = speed * Vector3d(0.3, -0.4, 0.5).normalized();
    const SweepHit hit = sweep_point(shape, -0.6 * displacement, 0.4 * displacement, 0.0);
    ASSERT_TRUE(hit.hit);
    EXPECT_NEAR(hit.point.norm(), 0.5, 0.01);
    EXPECT_LT(hit.normal.dot(displacement.normalized()), -0.95);
  }
}

}  // namespace
}  // namespace pliant
