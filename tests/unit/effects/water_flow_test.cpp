#include "pliant/effects/wetness/water_flow.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/mesh/grid.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {
namespace {

struct Sheet {
  explicit Sheet(int cells, const WaterFlow::Rates& rates)
      : grid{0.2, 0.1, cells + 1, cells / 2 + 1},
        mesh(make_grid(grid)),
        areas(vertex_areas(mesh)),
        flow(mesh.vertices, mesh.triangles, areas, rates),
        wetness(Eigen::VectorXd::Zero(areas.size())) {}
  double water() const { return areas.dot(wetness); }

  GridOptions grid;
  TriangleMesh mesh;
  Eigen::VectorXd areas;
  WaterFlow flow;
  Eigen::VectorXd wetness;
};

// w = 1/2 + 1/4 cos(pi x/L) decays as exp(-D (pi/L)² t) and keeps its water.
TEST(WaterFlow, SpreadsByDiffusion) {
  double before = 0.0;
  for (const int cells : {8, 16, 32}) {
    Sheet s(cells, {1e-4, 0.0});
    const double k = M_PI / 0.2;
    s.wetness = 0.5 + 0.25 * (k * (s.mesh.vertices.row(0).array() + 0.1)).cos().transpose();
    const double water = s.water();
    for (int n = 0; n < 2000; ++n) {
      s.flow.flow(s.mesh.vertices, Eigen::Vector3d::UnitZ(), 5e-3, s.wetness);
    }
    EXPECT_NEAR(s.water(), water, 1e-12 * water);
    const double amplitude = s.wetness.maxCoeff() - 0.5;
    const double error = std::abs(amplitude - 0.25 * std::exp(-1e-4 * k * k * 10.0));
    if (before > 0.0) {
      EXPECT_LT(error, 0.4 * before) << cells;
    }
    before = error;
  }
  EXPECT_LT(before, 2e-3 * 0.25);
}

TEST(WaterFlow, SinksAndDripsAndLosesNothing) {
  Sheet s(20, {0.0, 0.01});
  s.wetness.setConstant(0.7);
  double dripped = 0.0, highest = 0.0;
  const double water = s.water();
  // It hangs along x.
  for (int n = 0; n < 3000; ++n) {
    dripped += s.flow.flow(s.mesh.vertices, Eigen::Vector3d::UnitX(), 0.01, s.wetness);
    EXPECT_GE(s.wetness.minCoeff(), 0.0);
    highest = std::max(highest, s.wetness.maxCoeff());
    ASSERT_LE(highest, 1.0);
  }
  EXPECT_NEAR(s.water() + dripped, water, 1e-12);
  EXPECT_GT(dripped, 0.1 * water);
  const double top = s.wetness[s.grid.columns - 1], bottom = s.wetness[0];
  EXPECT_LT(top, 0.3);
  EXPECT_GT(bottom, top);
}

TEST(WaterFlow, LyingFlatNothingSinks) {
  Sheet s(8, {0.0, 0.01});
  s.wetness.setLinSpaced(0.0, 1.0);
  const Eigen::VectorXd before = s.wetness;
  EXPECT_EQ(s.flow.flow(s.mesh.vertices, Eigen::Vector3d::UnitZ(), 1.0, s.wetness), 0.0);
  EXPECT_EQ(s.wetness, before);
}

TEST(WaterFlow, StaysBoundedAtAnyStep) {
  Sheet s(10, {1.0, 1.0});
  for (int i = 0; i < s.wetness.size(); ++i) s.wetness[i] = i % 3 == 0 ? 1.0 : 0.0;
  const double water = s.water();
  double dripped = 0.0;
  for (const double dt : {1e-6, 1e-3, 1.0, 1e6}) {
    dripped += s.flow.flow(s.mesh.vertices, Eigen::Vector3d::UnitY(), dt, s.wetness);
    EXPECT_GE(s.wetness.minCoeff(), 0.0);
    EXPECT_LE(s.wetness.maxCoeff(), 1.0);
    EXPECT_NEAR(s.water() + dripped, water, 1e-12);
  }
}

// Of a triangle with its right angle at the last vertex the edges to that carry all water, half of
// 1/2 of their length wide: with 1/6 of area its wetness follows at 6 D, that of the others at 3 D.
// Up to there a step leaves each vertex between what it and its neighbours were; beyond, it
// overshoots.
TEST(WaterFlow, StableStepCountsBothEndsOfAnEdge) {
  Eigen::Matrix3Xd rest(3, 3);
  rest << 1.0, 0.0, 0.0,  //
      0.0, 1.0, 0.0,      //
      0.0, 0.0, 0.0;
  Eigen::Matrix3Xi triangles(3, 1);
  triangles << 0, 1, 2;
  constexpr double kDiffusion = 1e-4;
  WaterFlow flow(rest, triangles, Eigen::VectorXd::Constant(3, 1.0 / 6.0), {kDiffusion, 0.0});
  Eigen::VectorXd wetness(3);
  wetness << 0.4, 0.4, 0.6;
  flow.flow(rest, Eigen::Vector3d::UnitZ(), 0.99 / (3.0 * kDiffusion), wetness);
  EXPECT_GE(wetness.minCoeff(), 0.4 - 1e-12);
  EXPECT_LE(wetness.maxCoeff(), 0.6 + 1e-12);
  EXPECT_NEAR(wetness.sum(), 1.4, 1e-12);
}

}  // namespace
}  // namespace pliant
