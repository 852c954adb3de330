#include "pliant/geometry/meshing/stuffing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/mesh/dihedral_angles.h"
#include "pliant/geometry/mesh/display_surface.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "pliant/math/pi.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/worlds/surfaces.h"

namespace pliant {
namespace {

StuffingOptions with_cells(double size) {
  StuffingOptions options;
  options.cell_size = size;
  return options;
}

StuffingOptions with_count(int count) {
  StuffingOptions options;
  options.tetrahedra = count;
  return options;
}

void expect_good_angles(const TetrahedralMesh& mesh) {
  const AngleRange angles = dihedral_angles(mesh);
  EXPECT_GE(angles.least, kStuffingLeastAngle);
  EXPECT_LE(angles.greatest, kStuffingGreatestAngle);
}

TriangleMesh boundary(const TetrahedralMesh& mesh) {
  return {mesh.vertices, boundary_triangles(mesh)};
}

/// The largest distance of the boundary's vertices from a surface.
double boundary_error(const TetrahedralMesh& mesh, const TriangleMesh& surface) {
  const NearestTriangle nearest(surface);
  double worst = 0.0;
  const Eigen::Matrix3Xi triangles = boundary_triangles(mesh);
  for (const auto t : triangles.colwise()) {
    for (int k = 0; k < 3; ++k) worst = std::max(worst, nearest(mesh.vertices.col(t[k])).distance);
  }
  return worst;
}

TEST(Stuffing, FillsASphereToTheSquareOfTheCells) {
  const TriangleMesh sphere = icosphere(5);
  double last_volume = 0.0, last_distance = 0.0;
  for (const double size : {0.4, 0.2, 0.1}) {
    const TetrahedralMesh mesh = stuff(sphere, with_cells(size));
    EXPECT_NO_THROW(validate(mesh, "sphere"));
    EXPECT_GT(volumes(mesh).minCoeff(), 0.0);
    expect_good_angles(mesh);
    const double volume = std::abs(volumes(mesh).sum() - signed_volume(sphere));
    const double distance = boundary_error(mesh, sphere);
    // Linear interpolation over an edge of that length, curvature 1: error below size^2 / 8.
    EXPECT_LT(distance, size * size / 8.0);
    if (last_volume > 0.0) {
      EXPECT_LT(volume, last_volume / 2.5) << size;
      EXPECT_LT(distance, last_distance / 2.0) << size;
    }
    last_volume = volume;
    last_distance = distance;
  }
}

TEST(Stuffing, KeepsAnglesForAnyPlaceOfTheSurfaceInTheLattice) {
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    TriangleMesh surface = round % 2 == 0 ? torus_surface(1.0, random(0.2, 0.5), 24, 12)
                                          : box_surface({random(0.2, 1.0), random(0.2, 1.0), 0.5});
    surface.vertices = random.rotation() * surface.vertices;
    surface.vertices.colwise() += random.vector(10.0);
    const TetrahedralMesh mesh = stuff(surface, with_cells(random(0.1, 0.4)));
    EXPECT_NO_THROW(validate(mesh, "round " + std::to_string(round)));
    expect_good_angles(mesh);
  }
}

TEST(Stuffing, ATorusStaysOne) {
  const TriangleMesh torus = torus_surface(1.0, 0.3, 96, 48);
  const TetrahedralMesh mesh = stuff(torus, with_cells(0.1));
  EXPECT_NEAR(volumes(mesh).sum(), 2.0 * kPi * kPi * 0.09, 0.02 * 2.0 * kPi * kPi * 0.09);
  const TriangleMesh outside = boundary(mesh);
  const Edges all = edges(outside);
  std::vector<char> used(static_cast<std::size_t>(outside.vertices.cols()), 0);
  for (const auto t : outside.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) used[static_cast<std::size_t>(t[k])] = 1;
  }
  const auto points = std::count(used.begin(), used.end(), 1);
  EXPECT_EQ(points - static_cast<long>(all.vertices.size()) + outside.triangles.cols(), 0);
  EXPECT_TRUE(boundary_vertices(outside).empty());
}

TEST(Stuffing, MeetsATargetCount) {
  const TriangleMesh torus = torus_surface(0.1, 0.03, 48, 24);
  for (const int target : {1'000, 10'000, 100'000}) {
    const TetrahedralMesh mesh = stuff(torus, with_count(target));
    EXPECT_NEAR(static_cast<double>(mesh.tetrahedra.cols()), target, 0.06 * target);
    expect_good_angles(mesh);
  }
  EXPECT_GE(stuff(torus, with_count(1)).tetrahedra.cols(), 1);
}

TEST(Stuffing, GivesTheSameBitsForAnyNumberOfThreads) {
  const TriangleMesh sphere = icosphere(3);
  const TetrahedralMesh one = stuff(sphere, with_cells(0.15));
  set_threads(4);
  const TetrahedralMesh four = stuff(sphere, with_cells(0.15));
  set_threads(1);
  EXPECT_EQ(one.vertices, four.vertices);
  EXPECT_EQ(one.tetrahedra, four.tetrahedra);
}

TEST(Stuffing, ScaleAndPlaceChangeNothing) {
  const TriangleMesh sphere = icosphere(3);
  const Eigen::Index count = stuff(sphere, with_cells(0.25)).tetrahedra.cols();
  for (const double scale : {0x1p-20, 0x1p20}) {
    EXPECT_EQ(stuff(scaled(sphere, scale), with_cells(0.25 * scale)).tetrahedra.cols(), count);
  }
  const TetrahedralMesh far = stuff(moved(sphere, {1000, 1000, -1000}), with_cells(0.25));
  EXPECT_NEAR(static_cast<double>(far.tetrahedra.cols()), static_cast<double>(count), 8.0);
}

TEST(Stuffing, PartsThatOverlapBecomeOneSolid) {
  const TriangleMesh sphere = icosphere(4);
  const TriangleMesh pair = together(sphere, moved(sphere, {1, 0, 0}));
  const TetrahedralMesh mesh = stuff(pair, with_cells(0.1));
  EXPECT_NO_THROW(validate(mesh, "pair"));
  expect_good_angles(mesh);
  // Two unit balls less their lens, whose caps are 1/2 high: cap = pi h^2 (3 - h) / 3.
  const double cap = kPi * 0.25 * 2.5 / 3.0;
  EXPECT_NEAR(volumes(mesh).sum(), 2.0 * (4.0 / 3.0 * kPi - cap), 0.05);
}

TEST(Stuffing, SmallHolesAreClosed) {
  const TriangleMesh whole = icosphere(4);
  const TriangleMesh holed = without_last(whole, 1);
  const TetrahedralMesh a = stuff(whole, with_cells(0.2)), b = stuff(holed, with_cells(0.2));
  EXPECT_NEAR(volumes(a).sum(), volumes(b).sum(), 1e-3);
  expect_good_angles(b);
}

TEST(Stuffing, OpenSurfacesAreRefused) {
  expect_refusal([&] { stuff(without_last(icosphere(1), 2), with_cells(0.1), "body.surface"); },
                 {"body.surface: the surface is open", "edges", "m wide", "hole_size"});
  StuffingOptions allowed = with_cells(0.1);
  allowed.hole_size = 2.0;
  EXPECT_GT(stuff(without_last(icosphere(1), 2), allowed).tetrahedra.cols(), 0);
  expect_refusal([&] { stuff(square_surface(1.0), with_cells(0.1)); }, {"open", "4 edges"});
}

TEST(Stuffing, BadSurfacesAreRefused) {
  const StuffingOptions options = with_cells(0.2);
  expect_refusal([&] { stuff(TriangleMesh{}, options, "ball"); }, {"ball: ", "no vertices"});
  TriangleMesh empty = icosphere(1);
  empty.triangles.resize(3, 0);
  expect_refusal([&] { stuff(empty, options); }, {"no triangles"});
  TriangleMesh nan = icosphere(1);
  nan.vertices(1, 3) = std::nan("");
  expect_refusal([&] { stuff(nan, options); }, {"not finite: 3"});
  TriangleMesh inside_out = icosphere(1);
  inside_out.triangles.row(1).swap(inside_out.triangles.row(2));
  expect_refusal([&] { stuff(inside_out, options); }, {"inside out", "-3.", "reverse"});
  TriangleMesh one_flipped = icosphere(1);
  std::swap(one_flipped.triangles(1, 7), one_flipped.triangles(2, 7));
  expect_refusal([&] { stuff(one_flipped, options); }, {"wind the other way"});
  TriangleMesh fin = icosphere(1);
  fin.vertices.conservativeResize(3, fin.vertices.cols() + 1);
  fin.vertices.rightCols(1) << 0, 0, 3;
  fin.triangles.conservativeResize(3, fin.triangles.cols() + 1);
  fin.triangles.rightCols(1) << fin.triangles(0, 0), fin.triangles(1, 0),
      static_cast<int>(fin.vertices.cols()) - 1;
  expect_refusal([&] { stuff(fin, options); }, {"edge", "triangles"});
}

TEST(Stuffing, SolidsTooThinForTheirCellsAreRefused) {
  expect_refusal(
      [] {
        stuff(box_surface({0.5, 0.5, 0.001}), with_cells(0.2), "plate");
      },
      {"plate: there is no interior", "1 x 1 x 0.002", "0.2 m", "smaller cell_size"});
  EXPECT_GT(stuff(box_surface({0.5, 0.5, 0.05}), with_cells(0.05)).tetrahedra.cols(), 0);
}

// Samples lie half a cell apart, with four more on each side of the body: along an edge of 1 m in
// cells of h that makes 2/h + 9 of the 310.7 whose cube is 3e7, so that h is 2/301 m.
TEST(Stuffing, NamesTheSmallestCellsThatItsSamplesAllow) {
  expect_refusal(
      [] {
        stuff(box_surface({0.5, 0.5, 0.5}), with_cells(1e-3), "cube");
      },
      {"cube: cell_size is 0.001 m: allowed is [0.00664, 1]", "more than 3e+07"});
}

TEST(Stuffing, OptionsOutsideTheirRangeAreRefused) {
  const TriangleMesh sphere = icosphere(1);
  for (const double size :
       {-1.0, std::nan(""), std::numeric_limits<double>::infinity(), 1e-5, 3.0}) {
    expect_refusal([&] { stuff(sphere, with_cells(size)); }, {"cell_size is", "allowed"});
  }
  for (const int count : {0, -5, kMaxTetrahedra + 1}) {
    expect_refusal([&] { stuff(sphere, with_count(count)); }, {"tetrahedra is", "[1, 10000000]"});
  }
  StuffingOptions options;
  options.hole_size = std::nan("");
  expect_refusal([&] { stuff(sphere, options); }, {"hole_size is nan"});
}

}  // namespace
}  // namespace pliant
