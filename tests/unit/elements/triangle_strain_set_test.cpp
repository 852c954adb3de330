#include "pliant/elements/cloth/triangle_strain_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/geometry/mesh/grid.h"
#include "support/expect_refusal.h"
#include "support/meshes/sheet_triangulations.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

const double kInfinity = std::numeric_limits<double>::infinity();

/// A sheet of 0.6 m², its triangles of different shapes.
TriangleMesh sheet() {
  Random random(4);
  TriangleMesh mesh = make_grid({1.0, 0.6, 6, 5});
  for (int i : {7, 8, 9, 10, 13, 14, 15, 16, 19, 20, 21, 22}) {
    mesh.vertices.col(i).head<2>() += random.vector(0.03).head<2>();
  }
  return mesh;
}

Positions uniform_warp(const TriangleMesh& mesh, const Eigen::Vector3d& direction) {
  return direction.replicate(1, mesh.triangles.cols());
}

/// The sheet with warp at `angle` to x.
TriangleStrainSet make(const TriangleMesh& mesh, const MembraneMaterial& material, double angle) {
  return TriangleStrainSet(
      mesh, uniform_warp(mesh, {3.0 * std::cos(angle), 3.0 * std::sin(angle), 0.0}), material);
}

Eigen::Matrix3d in_plane(double xx, double xy, double yx, double yy) {
  Eigen::Matrix3d map = Eigen::Matrix3d::Identity();
  map.topLeftCorner<2, 2>() << xx, xy, yx, yy;
  return map;
}

TEST(TriangleStrainSet, SmallStrainsCostWhatTheMaterialSays) {
  const TriangleMesh mesh = sheet();
  const MembraneMaterial material{300.0, 200.0, 50.0, 0.0, {}, {}};
  const TriangleStrainSet set = make(mesh, material, 0.0);
  const double e = 1e-5;
  const auto density = [&](const Eigen::Matrix3d& map) {
    return set.energy(map * mesh.vertices) / (0.5 * e * e * 0.6);
  };
  // Third order: 1e-5 of it.
  EXPECT_NEAR(density(in_plane(1 + e, 0, 0, 1)), 300.0, 0.01);
  EXPECT_NEAR(density(in_plane(1, 0, 0, 1 + e)), 200.0, 0.01);
  EXPECT_NEAR(density(in_plane(1 + e, 0, 0, 1 - e)), 500.0, 0.01);  // no Poisson effect
  EXPECT_NEAR(density(in_plane(1, e, 0, 1)), 50.0, 0.01);           // shear angle e
  EXPECT_NEAR(density(in_plane(1, e / 2, e / 2, 1)), 50.0, 0.01);
  EXPECT_NEAR(density(in_plane(1, -e, e, 1)), 0.0, 0.01);  // a turn
}

TEST(TriangleStrainSet, HomogeneousStrainIsInEquilibriumOnEveryMesh) {
  const MembraneMaterial material{300.0, 200.0, 50.0, 0.0, {}, {}};
  const Eigen::Matrix3d map = in_plane(1.1, 0.1, -0.05, 0.95);
  const GridOptions grid{1.0, 0.6, 7, 6};
  const TriangleMesh regular = make_grid(grid);
  const double energy = make(regular, material, 0.3).energy(map * regular.vertices);
  for (const Triangulation kind : kTriangulations) {
    const TriangleMesh mesh = triangulated(grid, kind);
    const TriangleStrainSet set = make(mesh, material, 0.3);
    const Positions x = map * mesh.vertices;
    EXPECT_NEAR(set.energy(x), energy, 1e-12 * energy) << name_of(kind);
    const Forces f = forces_of(set, x);
    for (int i = 0; i < x.cols(); ++i) {
      const Eigen::Vector3d at = mesh.vertices.col(i);
      if (std::abs(at.x()) > 0.499 || std::abs(at.y()) > 0.299) continue;
      EXPECT_LE(f.col(i).norm(), 1e-12 * f.colwise().norm().maxCoeff()) << name_of(kind);
    }
  }
}

TEST(TriangleStrainSet, WarpMayRunAnywhere) {
  const TriangleMesh mesh = sheet();
  const MembraneMaterial material{300.0, 200.0, 50.0, 20.0, {0.95, 1.05}, {0.9, 1.02}};
  const TriangleStrainSet straight = make(mesh, material, 0.0);
  const TriangleStrainSet turned = make(mesh, material, 0.7);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Eigen::Matrix3d map = in_plane(1.2, 0.1, -0.05, 0.85);
  // The same deformation in the material's axes.
  const double energy = straight.energy(map * mesh.vertices);
  EXPECT_NEAR(turned.energy(turn * map * turn.transpose() * mesh.vertices), energy, 1e-12 * energy);
  // A part of the warp vector off the plane does not matter.
  const TriangleStrainSet leaning(mesh, uniform_warp(mesh, {1e-3, 0.0, 0.5}), material);
  EXPECT_NEAR(leaning.energy(map * mesh.vertices), energy, 1e-12 * energy);
}

TEST(TriangleStrainSet, LimitsActBeyondThemOnly) {
  const TriangleMesh mesh = sheet();
  const MembraneMaterial material{0.0, 0.0, 0.0, 100.0, {0.9, 1.1}, {0.8, kInfinity}};
  const TriangleStrainSet set = make(mesh, material, 0.0);
  const auto energy = [&](double warp, double weft) {
    return set.energy(in_plane(warp, 0, 0, weft) * mesh.vertices);
  };
  EXPECT_EQ(energy(1.05, 0.85), 0.0);
  EXPECT_EQ(energy(0.95, 5.0), 0.0);
  EXPECT_NEAR(energy(1.2, 1.0), 0.5 * 100.0 * 0.01 * 0.6, 1e-12);
  EXPECT_NEAR(energy(0.8, 0.7), 0.5 * 100.0 * (0.01 + 0.01) * 0.6, 1e-12);
}

TEST(TriangleStrainSet, StretchesPerTriangle) {
  const TriangleMesh mesh = sheet();
  const TriangleStrainSet set = make(mesh, {1.0, 1.0, 0.0, 0.0, {}, {}}, 0.0);
  Positions x = in_plane(1.3, 0, 0, 0.9) * mesh.vertices;
  Eigen::Matrix2Xd stretches = set.stretches(x);
  for (const auto each : stretches.colwise()) {
    EXPECT_NEAR(each[0], 1.3, 1e-13);
    EXPECT_NEAR(each[1], 0.9, 1e-13);
  }
  // In the mesh's order: only triangles of vertex 0 notice that it moved.
  x.col(0) *= 1.5;
  stretches = set.stretches(x);
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const bool touched = (mesh.triangles.col(t).array() == 0).any();
    EXPECT_EQ(std::abs(stretches(0, t) - 1.3) > 1e-9, touched) << t;
  }
}

TEST(TriangleStrainSet, CollapsedTrianglesStayFinite) {
  const TriangleMesh mesh = sheet();
  TriangleStrainSet set = make(mesh, {300.0, 200.0, 50.0, 20.0, {}, {}}, 0.3);
  for (const Eigen::Matrix3d& map :
       {in_plane(0, 0, 0, 0), in_plane(1, 0, 0, 0), in_plane(1, 1, 1, 1), in_plane(1, -1, 1, -1),
        in_plane(1e-200, 0, 0, 1e-200), in_plane(-1, 0, 0, -1), in_plane(1, 0, 0, -1)}) {
    Positions x = map * mesh.vertices;
    EXPECT_TRUE(std::isfinite(set.energy(x)));
    EXPECT_TRUE(forces_of(set, x).allFinite()) << map;
    EXPECT_TRUE(stiffness_of(set, x).allFinite()) << map;
    const Eigen::MatrixXd projected = stiffness_of(set, x, Definiteness::kProjected);
    EXPECT_GE(least_eigenvalue(projected), -1e-10 * projected.norm()) << map;
    set.reset_multipliers();
    set.relax(Eigen::VectorXd::Constant(30, 1e3), 0.01, x);
    EXPECT_TRUE(x.allFinite()) << map;
  }
}

TEST(TriangleStrainSet, RefusesBadInput) {
  const TriangleMesh mesh = sheet();
  const Positions warp = uniform_warp(mesh, {1, 0, 0});
  const auto refuse = [&](const MembraneMaterial& material, const std::string& part) {
    expect_refusal([&] { TriangleStrainSet(mesh, warp, material); }, {"triangle_strain", part});
  };
  for (const double bad : {-1.0, kInfinity, std::nan("")}) {
    refuse({bad, 1, 1, 1, {}, {}}, "warp is");
    refuse({1, bad, 1, 1, {}, {}}, "weft is");
    refuse({1, 1, bad, 1, {}, {}}, "shear is");
    refuse({1, 1, 1, bad, {}, {}}, "limit is");
  }
  refuse({}, "all 0");
  refuse({1, 1, 1, 1, {1.1, 1.2}, {}}, "warp: stretch limits 1.1 to 1.2");
  refuse({1, 1, 1, 1, {}, {0.0, 1.2}}, "weft: stretch limits 0 to 1.2");
  Positions bad_warp = warp;
  bad_warp.col(3) << 0, 0, 1;
  expect_refusal(
      [&] {
        TriangleStrainSet(mesh, bad_warp, {1, 1, 1, 0, {}, {}});
      },
      {"warp vector (0, 0, 1) of triangle 3", "no part in its plane"});
  bad_warp.col(3).setConstant(std::nan(""));
  expect_refusal([&] { TriangleStrainSet(mesh, bad_warp, {1, 1, 1, 0, {}, {}}); }, {"triangle 3"});
  expect_refusal(
      [&] {
        TriangleStrainSet(mesh, warp.leftCols(4), {1, 1, 1, 0, {}, {}});
      },
      {"4 warp vectors for 40 triangles"});
}

}  // namespace
}  // namespace pliant
