#include "pliant/core/body/surface_bends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/meshing/surface_samples.h"
#include "support/random.h"

namespace pliant::surface_bends_test {
namespace {

/// Points of a shape with their normals, carried by four particles at rest, which then are turned
/// and moved.
struct Carried {
  explicit Carried(const Shape& shape, double spacing) {
    Eigen::Matrix3Xd points = sample_surface(shape.surface(), spacing);
    normals.resize(3, points.cols());
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const SurfacePoint found = shape.query(points.col(i));
      points.col(i) -= found.distance * found.normal;
      normals.col(i) = found.normal;
    }
    Positions rest(3, 4);
    rest << 0.3, 0.3, -0.2, -0.3,  //
        0.2, -0.2, 0.25, -0.2,     //
        0.1, -0.1, -0.1, 0.2;
    Eigen::Matrix4d places;
    places << rest, Eigen::RowVector4d::Ones();
    Eigen::Matrix4Xd targets(4, points.cols());
    targets << points, Eigen::RowVectorXd::Ones(points.cols());
    const Eigen::Matrix4Xi particles = Eigen::Vector4i(0, 1, 2, 3).replicate(1, points.cols());
    carried = EmbeddedPoints(particles, Eigen::Matrix4Xd(places.inverse() * targets));
    bends = SurfaceBends(normals, carried, rest);
    Random random(1);
    pose.linear() = random.rotation();
    pose.translation() = Eigen::Vector3d(1.0, -2.0, 0.5);
    x = pose * rest;
  }

  /// Where a point that faces `direction` comes, in the frame of the shape.
  Eigen::Vector3d place(int point, const Eigen::Vector3d& direction) const {
    const Eigen::Vector4d weights = bends.farthest(point, carried, x, pose.linear() * direction);
    EXPECT_NEAR(weights.sum(), 1.0, 1e-12);
    return pose.inverse() * Eigen::Vector3d(x * weights);
  }

  Eigen::Matrix3Xd normals;
  EmbeddedPoints carried;
  SurfaceBends bends;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  Positions x;
};

TEST(SurfaceBends, PointsOfASphereComeToTheOnePlaceThatTouches) {
  constexpr double kRadius = 0.4;
  const Carried body(Sphere(kRadius), 0.05);
  int moved = 0;
  for (int i = 0; i < body.carried.size(); ++i) {
    // Off the opposite of the normal by less than the reach of the points.
    Random random(static_cast<std::uint64_t>(i));
    const Eigen::Vector3d direction =
        (-body.normals.col(i) + random.positions(1, 0.03).col(0)).normalized();
    EXPECT_LE((body.place(i, direction) + kRadius * direction).norm(), 1e-9);
    moved += (kRadius * body.normals.col(i) + kRadius * direction).norm() > 1e-6;
  }
  EXPECT_EQ(moved, body.carried.size());
  EXPECT_GT(body.bends.most_rise(), 0.0);
  EXPECT_LT(body.bends.most_rise(), 0.05 * 0.05 / kRadius * 2.0);
}

TEST(SurfaceBends, PointsOfACylinderGoRoundItAndNotAlong) {
  constexpr double kRadius = 0.3;
  const Carried body(Cylinder(kRadius, 1.0), 0.05);
  int on_the_side = 0;
  for (int i = 0; i < body.carried.size(); ++i) {
    const Eigen::Vector3d normal = body.normals.col(i);
    const Eigen::Vector3d own = body.pose.inverse() * body.carried.position(body.x, i);
    const Eigen::Vector3d tilted =
        (-normal + 0.05 * normal.cross(Eigen::Vector3d::UnitZ())).normalized();
    const Eigen::Vector3d place = body.place(i, tilted);
    EXPECT_NEAR(place.z(), own.z(), 1e-12);
    if (std::abs(normal.z()) > 0.5) {
      EXPECT_LE((place - own).norm(), 1e-12) << "its ends are flat";
      continue;
    }
    EXPECT_NEAR(place.head<2>().norm(), kRadius, 1e-9);
    ++on_the_side;
  }
  EXPECT_GT(on_the_side, 100);
}

TEST(SurfaceBends, OfAFlatBodyAndOfPointsThatFaceElsewhereNothingMoves) {
  const Carried box(Box({0.4, 0.5, 0.6}), 0.05);
  for (int i = 0; i < box.carried.size(); ++i) {
    EXPECT_EQ(box.bends.spacing(i), 0.0) << i;
  }
  EXPECT_EQ(box.bends.most_rise(), 0.0);
  const Carried ball(Sphere(0.4), 0.05);
  const Eigen::Vector3d own = ball.pose.inverse() * ball.carried.position(ball.x, 0);
  EXPECT_LE((ball.place(0, ball.normals.col(0)) - own).norm(), 1e-12);
  EXPECT_TRUE(SurfaceBends(Eigen::Matrix3Xd(3, 0), ball.carried, ball.x).is_empty());
}

TEST(SurfaceBends, WhatRollsIsAlongDirectionsInWhichTheSurfaceBends) {
  const auto rolls = [](const Carried& body, int point) {
    const Eigen::Vector3d normal = -(body.pose.linear() * body.normals.col(point));
    const Eigen::Vector3d u = normal.cross(Eigen::Vector3d(0.3, -0.2, 0.5));
    const Eigen::Vector3d found = body.bends.along_bends(point, body.carried, body.x, normal, u);
    // From the other side nothing touches here.
    EXPECT_TRUE(body.bends.along_bends(point, body.carried, body.x, -normal, u).isZero(0.0));
    return std::pair(Eigen::Vector3d(body.pose.linear().transpose() * u),
                     Eigen::Vector3d(body.pose.linear().transpose() * found));
  };
  const Carried ball(Sphere(0.4), 0.05), box(Box({0.4, 0.5, 0.6}), 0.05);
  const Carried cylinder(Cylinder(0.3, 1.0), 0.05);
  for (int i = 0; i < ball.carried.size(); ++i) {
    const auto [u, found] = rolls(ball, i);
    EXPECT_LE((found - u).norm(), 1e-12);
  }
  for (int i = 0; i < box.carried.size(); ++i) EXPECT_TRUE(rolls(box, i).second.isZero(0.0));
  int round = 0;
  for (int i = 0; i < cylinder.carried.size(); ++i) {
    const auto [u, found] = rolls(cylinder, i);
    if (cylinder.bends.spacing(i) == 0.0) continue;
    EXPECT_NEAR(found.z(), 0.0, 1e-9);
    EXPECT_LE((found.head<2>() - u.head<2>()).norm(), 1e-6);
    ++round;
  }
  EXPECT_GT(round, 100);
}

}  // namespace
}  // namespace pliant::surface_bends_test
