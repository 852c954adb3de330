#include "pliant/geometry/mesh/sheet_meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

/// Vertices - edges + triangles: 1 of a disc, 0 of a band.
Eigen::Index euler(const TriangleMesh& mesh) {
  return mesh.vertices.cols() - static_cast<Eigen::Index>(edges(mesh).vertices.size()) +
         mesh.triangles.cols();
}

double area_of(const TriangleMesh& mesh) { return vertex_areas(mesh).sum(); }

Eigen::Vector3d normal_of(const TriangleMesh& mesh, Eigen::Index t) {
  const Eigen::Vector3i v = mesh.triangles.col(t);
  const Eigen::Vector3d a = mesh.vertices.col(v[1]) - mesh.vertices.col(v[0]);
  return a.cross(Eigen::Vector3d(mesh.vertices.col(v[2]) - mesh.vertices.col(v[0]))).normalized();
}

TEST(Tube, IsABandWithTwoOpenEnds) {
  for (const int around : {3, 24, 25}) {
    const TriangleMesh mesh = make_tube({0.2, 0.5, around, 6});
    EXPECT_NO_THROW(validate(mesh, "tube"));
    EXPECT_EQ(mesh.vertices.cols(), around * 7);
    EXPECT_EQ(euler(mesh), 0);
    EXPECT_EQ(boundary_vertices(mesh).size(), static_cast<std::size_t>(2 * around));
    // A prism of chords.
    EXPECT_NEAR(area_of(mesh), 0.5 * around * 2.0 * 0.2 * std::sin(M_PI / around), 1e-12);
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3d x = mesh.vertices.col(mesh.triangles(0, t));
      EXPECT_GT(normal_of(mesh, t).dot(Eigen::Vector3d(x.x(), x.y(), 0.0)), 0.0);
    }
  }
}

TEST(HoledSheet, IsAFlatBandAroundItsHole) {
  const TriangleMesh mesh = make_holed_sheet({0.6, 0.4, 0.1, 10, 5});
  EXPECT_NO_THROW(validate(mesh, "sheet"));
  EXPECT_EQ(mesh.vertices.cols(), 40 * 6);
  EXPECT_EQ(euler(mesh), 0);
  EXPECT_EQ(boundary_vertices(mesh).size(), 80u);
  EXPECT_EQ(mesh.vertices.row(2).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_NEAR(mesh.vertices.colwise().norm().minCoeff(), 0.1, 1e-15);
  EXPECT_EQ(mesh.vertices.row(0).maxCoeff(), 0.3);
  EXPECT_EQ(mesh.vertices.row(1).minCoeff(), -0.2);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    EXPECT_GT(normal_of(mesh, t).z(), 0.99) << t;
  }
  // The hole is a polygon of 40 sides that are not quite of one length.
  EXPECT_NEAR(area_of(mesh), 0.24 - M_PI * 0.01, 0.01 * M_PI * 0.01);
}

TEST(SheetMeshes, RefuseWhatCannotBe) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, inf, std::nan("")}) {
    expect_refusal([&] { make_tube({bad, 0.5, 8, 2}); }, {"radius", "positive"});
    expect_refusal([&] { make_tube({0.5, bad, 8, 2}); }, {"length", "positive"});
    expect_refusal([&] { make_holed_sheet({bad, 0.5, 0.1, 8, 2}); }, {"width", "positive"});
    expect_refusal([&] { make_holed_sheet({0.5, bad, 0.1, 8, 2}); }, {"height", "positive"});
    expect_refusal([&] { make_holed_sheet({0.5, 0.5, bad, 8, 2}); }, {"hole", "positive"});
  }
  expect_refusal([] { make_tube({0.1, 0.5, 2, 2}); }, {"around is 2", "at least 3"});
  expect_refusal([] { make_tube({0.1, 0.5, 8, 0}); }, {"along is 0"});
  expect_refusal([] { make_tube({0.1, 0.5, 100000, 100000}); }, {"triangles", "at most"});
  expect_refusal([] { make_holed_sheet({0.5, 0.4, 0.2, 8, 2}); }, {"hole is 0.2 m", "shorter"});
  expect_refusal([] { make_holed_sheet({0.5, 0.4, 0.1, 0, 2}); }, {"side is 0"});
  expect_refusal([] { make_holed_sheet({0.5, 0.4, 0.1, 4, 0}); }, {"rings is 0"});
}

}  // namespace
}  // namespace pliant
