#include "pliant/geometry/distance/primitive_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

std::vector<std::unique_ptr<Shape>> all_shapes() {
  std::vector<std::unique_ptr<Shape>> shapes;
  shapes.push_back(std::make_unique<Plane>());
  shapes.push_back(std::make_unique<Sphere>(0.7));
  shapes.push_back(std::make_unique<Box>(Vector3d(1.0, 0.6, 0.2)));
  shapes.push_back(std::make_unique<Box>(Vector3d(1.0, 1.0, 1.0)));
  shapes.push_back(std::make_unique<Capsule>(0.3, 0.8));
  shapes.push_back(std::make_unique<Cylinder>(0.4, 0.5));
  shapes.push_back(std::make_unique<Cylinder>(0.1, 2.0));
  return shapes;
}

class Points {
 public:
  explicit Points(unsigned seed) : random_(seed) {}
  Vector3d in_cube(double half) {
    return half * Vector3d(uniform_(random_), uniform_(random_), uniform_(random_));
  }
  double uniform() { return uniform_(random_); }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

// For every shape: a point of its surface, made from its definition rather than its distance.
Vector3d surface_point(const Shape& shape, Points& points) {
  if (const auto* sphere = dynamic_cast<const Sphere*>(&shape)) {
    return sphere->radius() * points.in_cube(1.0).normalized();
  }
  if (const auto* box = dynamic_cast<const Box*>(&shape)) {
    Vector3d p = points.in_cube(0.5);
    p[std::min(2, static_cast<int>(1.5 * (points.uniform() + 1.0)))] =
        std::copysign(0.5, points.uniform());
    return p.cwiseProduct(box->size());
  }
  const double angle = M_PI * points.uniform();
  const Vector3d around(std::cos(angle), std::sin(angle), 0.0);
  if (const auto* capsule = dynamic_cast<const Capsule*>(&shape)) {
    if (points.uniform() < 0.0) {
      return capsule->radius() * around +
             0.5 * capsule->length() * points.uniform() * Vector3d::UnitZ();
    }
    const Vector3d cap = capsule->radius() * points.in_cube(1.0).normalized();
    return cap + std::copysign(0.5 * capsule->length(), cap.z()) * Vector3d::UnitZ();
  }
  if (const auto* cylinder = dynamic_cast<const Cylinder*>(&shape)) {
    const double half = 0.5 * cylinder->length();
    if (points.uniform() < 0.0) {
      return cylinder->radius() * around + half * points.uniform() * Vector3d::UnitZ();
    }
    return cylinder->radius() * std::sqrt(std::abs(points.uniform())) * around +
           std::copysign(half, points.uniform()) * Vector3d::UnitZ();
  }
  return Vector3d(2.0 * points.uniform(), 2.0 * points.uniform(), 0.0);
}

TEST(PrimitiveShapes, DistanceIsThatToTheNearestOfManySurfacePoints) {
  for (const auto& shape : all_shapes()) {
    Points points(3);
    std::vector<Vector3d> surface(60000);
    for (Vector3d& p : surface) p = surface_point(*shape, points);
    for (int i = 0; i < 100; ++i) {
      const Vector3d p = points.in_cube(1.0);
      double nearest = 1e9;
      for (const Vector3d& q : surface) nearest = std::min(nearest, (p - q).norm());
      const double distance = std::abs(shape->distance(p));
      EXPECT_LE(distance, nearest + 1e-12) << shape->name() << " at " << p.transpose();
      EXPECT_NEAR(distance, nearest, 0.06) << shape->name() << " at " << p.transpose();
    }
  }
}

TEST(PrimitiveShapes, SignTellsInsideFromOutside) {
  EXPECT_LT(Plane().distance({5.0, 3.0, -0.1}), 0.0);
  EXPECT_GT(Plane().distance({5.0, 3.0, 0.1}), 0.0);
  EXPECT_EQ(Sphere(2.0).distance({0.0, 0.0, 0.0}), -2.0);
  EXPECT_EQ(Box(Vector3d(2.0, 4.0, 6.0)).distance({0.0, 0.0, 0.0}), -1.0);
  EXPECT_EQ(Capsule(0.5, 2.0).distance({0.0, 0.0, 1.0}), -0.5);
  EXPECT_EQ(Cylinder(2.0, 1.0).distance({0.0, 0.0, 0.0}), -0.5);
  EXPECT_DOUBLE_EQ(Cylinder(2.0, 2.0).distance({5.0, 0.0, 5.0}), 5.0);
}

TEST(PrimitiveShapes, NormalIsTheGradient) {
  constexpr double kStep = 1e-6;
  for (const auto& shape : all_shapes()) {
    Points points(5);
    int smooth = 0;
    for (int i = 0; i < 20000; ++i) {
      const Vector3d p = points.in_cube(1.0);
      Vector3d gradient;
      for (int k = 0; k < 3; ++k) {
        const Vector3d step = kStep * Vector3d::Unit(k);
        gradient[k] = (shape->distance(p + step) - shape->distance(p - step)) / (2.0 * kStep);
      }
      if (std::abs(gradient.norm() - 1.0) > 1e-6) continue;  // across a kink
      ++smooth;
      EXPECT_LT((gradient - shape->query(p).normal).norm(), 1e-3)
          << shape->name() << " at " << p.transpose();
    }
    EXPECT_GT(smooth, 19900) << shape->name();
  }
}

TEST(PrimitiveShapes, QueryAndDistanceAgree) {
  for (const auto& shape : all_shapes()) {
    Points points(7);
    for (int i = 0; i < 10000; ++i) {
      const Vector3d p = points.in_cube(1.5);
      EXPECT_NEAR(shape->query(p).distance, shape->distance(p), 1e-15) << shape->name();
    }
  }
}

void expect_sound(const Shape& shape, const Vector3d& p) {
  const SurfacePoint near = shape.query(p);
  const bool sound = std::isfinite(near.distance) && std::isfinite(shape.distance(p)) &&
                     std::abs(near.normal.norm() - 1.0) < 1e-9;
  if (!sound) {
    ADD_FAILURE() << shape.name() << " at " << p.transpose() << ": " << near.distance << ", "
                  << near.normal.transpose();
  }
}

TEST(PrimitiveShapes, AMillionPointsNeverGiveNaN) {
  const double scales[] = {1e-310, 1e-300, 1e-160, 1e-150, 1e-30, 1e-9, 0.5, 1.0, 1e6, 1e100};
  for (const auto& shape : all_shapes()) {
    Points points(11);
    for (int i = 0; i < 150000; ++i) expect_sound(*shape, points.in_cube(scales[i % 10]));
  }
}

TEST(PrimitiveShapes, SpecialPointsNeverGiveNaN) {
  const double values[] = {0.0, -0.0, 0.05, 0.1,    0.25,   0.3, 0.4,
                           0.5, 0.7,  1.0,  1e-300, 5e-324, 1e6};
  for (const auto& shape : all_shapes()) {
    for (const double x : values) {
      for (const double y : values) {
        for (const double z : values) {
          expect_sound(*shape, {x, y, z});
          expect_sound(*shape, {-x, -y, -z});
          // A rounding error away from edges and corners.
          expect_sound(*shape, {std::nextafter(x, 1e9), std::nextafter(y, 1e9), z});
        }
      }
    }
  }
}

TEST(PrimitiveShapes, SizesAtTheLimitsNeverGiveNaN) {
  for (const double size : {kMinShapeSize, kMaxShapeSize}) {
    Points points(13);
    for (int i = 0; i < 1000; ++i) {
      const Vector3d p = points.in_cube(i % 2 ? 2.0 * size : 1.0);
      expect_sound(Sphere(size), p);
      expect_sound(Box(Vector3d::Constant(size)), p);
      expect_sound(Capsule(size, size), p);
      expect_sound(Cylinder(size, size), p);
    }
  }
}

TEST(PrimitiveShapes, NormalsAreFixedWhereNoGradientExists) {
  const Vector3d centre = Vector3d::Zero();
  EXPECT_EQ(Sphere(1.0).query(centre).normal, Vector3d::UnitZ());
  EXPECT_EQ(Box(Vector3d::Ones()).query(centre).normal, Vector3d::UnitZ());
  EXPECT_EQ(Box(Vector3d(1.0, 1.0, 2.0)).query(centre).normal, Vector3d::UnitY());
  EXPECT_EQ(Capsule(1.0, 1.0).query(centre).normal, Vector3d::UnitX());
  EXPECT_EQ(Cylinder(0.5, 1.0).query(centre).normal, Vector3d::UnitZ());
  EXPECT_EQ(Cylinder(0.4, 1.0).query(centre).normal, Vector3d::UnitX());
}

TEST(PrimitiveShapes, SurfaceLiesOnTheShapeAndFillsItsBounds) {
  for (const auto& shape : all_shapes()) {
    const TriangleMesh surface = shape->surface();
    EXPECT_NO_THROW(validate(surface, shape->name()));
    for (const auto v : surface.vertices.colwise()) {
      if (shape->name() == "cylinder" && v.head<2>().norm() < 1e-12) continue;  // centre of an end
      EXPECT_NEAR(shape->distance(v), 0.0, 1e-12) << shape->name();
      EXPECT_LT(shape->bounds().exteriorDistance(Vector3d(v)), 1e-12);
    }
    if (shape->name() == "plane") continue;
    const Eigen::AlignedBox3d box(surface.vertices.rowwise().minCoeff(),
                                  surface.vertices.rowwise().maxCoeff());
    EXPECT_TRUE(box.isApprox(shape->bounds(), 1e-12)) << shape->name();
  }
}

TEST(PrimitiveShapes, PlaneIsBoundedAboveOnly) {
  const Eigen::AlignedBox3d box = Plane().bounds();
  EXPECT_EQ(box.max().z(), 0.0);
  EXPECT_TRUE(std::isinf(box.min().z()) && std::isinf(box.max().x()) && std::isinf(box.min().y()));
  EXPECT_NEAR(area(Plane().surface()), 4.0, 1e-12);
}

TEST(PrimitiveShapes, KnowTheirNamesAndAreConvex) {
  std::vector<std::string> names;
  for (const auto& shape : all_shapes()) {
    names.push_back(shape->name());
    EXPECT_TRUE(shape->convex());
  }
  EXPECT_EQ(names, (std::vector<std::string>{"plane", "sphere", "box", "box", "capsule", "cylinder",
                                             "cylinder"}));
}

TEST(PrimitiveShapes, RefuseBadSizes) {
  const double bad_sizes[] = {0.0,   -1.0,         1e-300,
                              1e300, std::nan(""), std::numeric_limits<double>::infinity()};
  for (const double bad : bad_sizes) {
    expect_refusal([&] { Sphere{bad}; }, {"sphere: radius", "allowed is [1e-09, "});
    expect_refusal([&] { Box{Vector3d(bad, 1, 1)}; }, {"box: size x", "allowed is"});
    expect_refusal([&] { Box{Vector3d(1, bad, 1)}; }, {"box: size y", "allowed is"});
    expect_refusal([&] { Box{Vector3d(1, 1, bad)}; }, {"box: size z", "allowed is"});
    expect_refusal([&] { Capsule(bad, 1.0); }, {"capsule: radius", "allowed is"});
    expect_refusal([&] { Capsule(1.0, bad); }, {"capsule: length", "allowed is"});
    expect_refusal([&] { Cylinder(bad, 1.0); }, {"cylinder: radius", "allowed is"});
    expect_refusal([&] { Cylinder(1.0, bad); }, {"cylinder: length", "allowed is"});
  }
}

}  // namespace
}  // namespace pliant
