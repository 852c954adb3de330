#include "pliant/geometry/patch/patch_polygons.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "pliant/geometry/meshing/embedding.h"
#include "pliant/geometry/meshing/stuffing.h"
#include "pliant/math/pi.h"
#include "support/expect_refusal.h"
#include "support/worlds/patch_bodies.h"

namespace pliant {
namespace {

/// Every edge has two triangles that run along it in opposite ways.
void expect_closed_polygons(const TriangleMesh& mesh) {
  EXPECT_NO_THROW(validate(mesh, "polygons"));
  EXPECT_TRUE(boundary_vertices(mesh).empty());
}

TEST(PatchPolygons, AreClosedAtEveryLevel) {
  const PatchSurface surface(sphere_patches(icosphere(0), 1e4));
  for (const int level : {1, 2, 3, 7, 16}) {
    const PatchPolygons polygons = polygonise(surface, level);
    EXPECT_EQ(polygons.mesh.triangles.cols(), 20 * level * level);
    EXPECT_EQ(polygons.mesh.vertices.cols(), 10 * level * level + 2);
    expect_closed_polygons(polygons.mesh);
  }
}

TEST(PatchPolygons, EdgesMeetToRoundOffFromBothSides) {
  const PatchSurface surface(sphere_patches(icosphere(1), 1e4));
  const PatchPolygons polygons = polygonise(surface, 5);
  const Eigen::Matrix3Xi& t = surface.body().base.triangles;
  int met = 0;
  for (int patch = 0; patch < surface.patches(); ++patch) {
    for (int other = 0; other < patch; ++other) {
      for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
          if (t(k, patch) != t((l + 1) % 3, other) || t((k + 1) % 3, patch) != t(l, other))
            continue;
          for (const double at : {0.1, 0.4, 0.7}) {
            Eigen::Vector3d mine = Eigen::Vector3d::Zero(), others = mine;
            mine[k] = others[(l + 1) % 3] = 1.0 - at;
            mine[(k + 1) % 3] = others[l] = at;
            EXPECT_LE((surface.point(patch, mine) - surface.point(other, others)).norm(), 1e-13);
            ++met;
          }
        }
      }
    }
  }
  EXPECT_EQ(met, 3 * 120);
}

TEST(PatchPolygons, NameThePlaceOfEachVertex) {
  const PatchSurface surface(three_patches());
  const PatchPolygons polygons = polygonise(surface, 6);
  for (int v = 0; v < polygons.mesh.vertices.cols(); ++v) {
    const Eigen::Vector3d p = surface.point(polygons.patch[v], polygons.barycentric.col(v));
    EXPECT_EQ(p, polygons.mesh.vertices.col(v));
  }
  EXPECT_EQ(polygons.mesh.vertices.leftCols(4), surface.body().base.vertices);
  // As open as the base: three boundary edges of six each.
  EXPECT_EQ(boundary_vertices(polygons.mesh).size(), 18u);
}

TEST(PatchPolygons, VolumeConvergesAsTheSquareOfTheGrid) {
  const PatchSurface surface(sphere_patches(icosphere(0), 1e6));
  const double exact = 4.0 / 3.0 * kPi;
  double last = 0.0;
  for (const int level : {4, 8, 16, 32}) {
    const double error = exact - signed_volume(polygonise(surface, level).mesh);
    if (last > 0.0) {
      EXPECT_NEAR(last / error, 4.0, 0.3) << level;
    }
    last = error;
  }
}

TEST(PatchPolygons, StayClosedUnderAnyDeformationOfTheirTetrahedra) {
  const PatchSurface surface(sphere_patches(icosphere(0), 1e4));
  const PatchPolygons polygons = polygonise(surface, 8);
  const TetrahedralMesh interior = stuff(polygons.mesh, {0.3, 1000, -1.0});
  const Embedding embedding = embed(polygons.mesh.vertices, interior);
  Random random(7);
  TriangleMesh deformed = polygons.mesh;
  deformed.vertices = embedded_positions(embedding, interior.tetrahedra, interior.vertices);
  EXPECT_LT((deformed.vertices - polygons.mesh.vertices).cwiseAbs().maxCoeff(), 1e-13);
  // Vertices are shared, so that only a closed mesh can come of it; its volume says that no patch
  // stayed behind.
  const Eigen::Matrix3d squeeze = Eigen::Vector3d(1.5, 1.2, 0.3).asDiagonal();
  deformed.vertices =
      embedded_positions(embedding, interior.tetrahedra, squeeze * interior.vertices);
  expect_closed_polygons(deformed);
  EXPECT_NEAR(signed_volume(deformed), 0.54 * signed_volume(polygons.mesh), 1e-12);
  deformed.vertices =
      embedded_positions(embedding, interior.tetrahedra,
                         random.positions(static_cast<int>(interior.vertices.cols()), 1.0));
  EXPECT_TRUE(boundary_vertices(deformed).empty());
  EXPECT_TRUE(deformed.vertices.allFinite());
}

TEST(PatchPolygons, LevelsOutsideTheirRangeAreRefused) {
  const PatchSurface surface(three_patches());
  for (const int level : {0, -1, 257}) {
    expect_refusal([&] { polygonise(surface, level); }, {"level of detail is", "[1, 256]"});
  }
  const PatchSurface fine(sphere_patches(icosphere(2), 10.0));
  expect_refusal([&] { polygonise(fine, 256); }, {"level of detail 256", "2.1e+07"});
}

}  // namespace
}  // namespace pliant
