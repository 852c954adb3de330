#include "pliant/geometry/search/normal_cones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant::normal_cones_test {
namespace {

/// A box of 2 x 2 x 2 m and points of it: within a face, on an edge, at a corner.
class BoxCones : public testing::Test {
 protected:
  static constexpr int kFace = 0, kEdge = 1, kCorner = 2;
  static NormalCones cones() {
    Eigen::Matrix3Xd points(3, 3);
    points.col(kFace) << 1.0, 0.25, -0.5;
    points.col(kEdge) << 1.0, 1.0, 0.25;
    points.col(kCorner) << 1.0, 1.0, 1.0;
    return {Box(Eigen::Vector3d::Constant(2.0)).surface(), points};
  }
};

TEST_F(BoxCones, KnowHowFarTheirFacesReach) {
  const NormalCones box = cones();
  EXPECT_NEAR(box.reach(kFace), 0.5, 1e-12);
  // To the edges across.
  EXPECT_NEAR(box.reach(kEdge), 0.75, 1e-12);
  EXPECT_NEAR(box.reach(kCorner), 2.0, 1e-12);
}

TEST_F(BoxCones, OfAFaceIsItsNormal) {
  const NormalCones box = cones();
  EXPECT_TRUE(box.part_within(kFace, {0.5, 0.3, -2.0}).isApprox(Eigen::Vector3d(0.5, 0, 0), 1e-12));
  EXPECT_TRUE(box.part_within(kFace, {-0.5, 0.3, 0.0}).isZero(0.0));
}

TEST_F(BoxCones, OfAnEdgeIsBetweenItsFaces) {
  const NormalCones box = cones();
  EXPECT_TRUE(
      box.part_within(kEdge, {0.5, 0.3, 7.0}).isApprox(Eigen::Vector3d(0.5, 0.3, 0), 1e-12));
  EXPECT_TRUE(box.part_within(kEdge, {0.5, -0.3, 7.0}).isApprox(Eigen::Vector3d(0.5, 0, 0), 1e-12));
  EXPECT_TRUE(box.part_within(kEdge, {-0.5, -0.3, 7.0}).isZero(0.0));
}

TEST_F(BoxCones, OfACornerIsBetweenItsThreeFaces) {
  const NormalCones box = cones();
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector3d direction(any(random), any(random), any(random));
    // Of an octant: what is not below 0.
    EXPECT_TRUE(box.part_within(kCorner, direction).isApprox(direction.cwiseMax(0.0), 1e-12) ||
                direction.maxCoeff() < 0.0);
  }
  EXPECT_TRUE(box.part_within(kCorner, {-1, -2, -3}).isZero(0.0));
}

// Where the surface bends inwards, what touches it may push in any direction.
TEST(NormalCones, AreUnknownWhereTheSurfaceIsNotConvex) {
  // A prism over a quadrangle with a dent at the origin.
  TriangleMesh dented;
  dented.vertices.resize(3, 8);
  const Eigen::Vector2d outline[4] = {{0, 0}, {1, 1}, {-1, 0}, {1, -1}};
  for (int k = 0; k < 4; ++k) {
    dented.vertices.col(k) << outline[k], 0.0;
    dented.vertices.col(k + 4) << outline[k], 1.0;
  }
  std::vector<Eigen::Vector3i> faces = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    faces.emplace_back(k, next, next + 4);
    faces.emplace_back(k, next + 4, k + 4);
  }
  dented.triangles.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f) {
    dented.triangles.col(static_cast<Eigen::Index>(f)) = faces[f];
  }
  const NormalCones cones(dented, dented.vertices);
  EXPECT_EQ(cones.reach(0), 0.0);
  EXPECT_EQ(cones.reach(4), 0.0);
  EXPECT_GT(cones.reach(2), 0.5);
}

}  // namespace
}  // namespace pliant::normal_cones_test
