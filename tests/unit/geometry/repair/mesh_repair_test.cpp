#include <gtest/gtest.h>

#include <cmath>

#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/repair/body_surface.h"
#include "pliant/geometry/repair/convex_hull.h"
#include "pliant/geometry/repair/generalized_winding.h"
#include "pliant/geometry/repair/isosurface.h"
#include "pliant/geometry/repair/mesh_cleaning.h"
#include "pliant/geometry/repair/outward.h"
#include "pliant/geometry/repair/sound_mesh.h"
#include "support/expect_refusal.h"
#include "support/meshes/broken_meshes.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

TEST(MeshCleaning, LeavesACleanMesh) {
  MeshCleaning done;
  const TriangleMesh clean = clean_mesh(fine_bracket(), done);
  EXPECT_EQ(done.joined + done.degenerate + done.repeated, 0);
  EXPECT_EQ(clean.vertices.cols(), fine_bracket().vertices.cols());
  EXPECT_EQ(clean.triangles.cols(), fine_bracket().triangles.cols());
}

TEST(MeshCleaning, JoinsVerticesOfCracksOnly) {
  MeshCleaning done;
  const TriangleMesh clean = clean_mesh(torn(fine_bracket(), 2e-6, 1), done);
  EXPECT_EQ(clean.vertices.cols(), fine_bracket().vertices.cols());
  EXPECT_EQ(count_edges(clean, 1, 1), 0);
  EXPECT_GT(done.joined, 0);
  // Two closed boxes, nearer to each other than cracks are wide, stay two.
  const TriangleMesh box = Box(Vector3d::Ones()).surface();
  const TriangleMesh pair = joined_meshes(box, moved(box, Vector3d(1.0 + 1e-6, 0.0, 0.0)));
  EXPECT_EQ(clean_mesh(pair, done).vertices.cols(), 16);
}

TEST(MeshCleaning, DropsWhatRepeatsOrHasNoArea) {
  TriangleMesh mesh = joined_meshes(fine_bracket(), fine_bracket());
  mesh = with_triangle(mesh, 5, 5, 6);
  MeshCleaning done;
  const TriangleMesh clean = clean_mesh(mesh, done);
  EXPECT_EQ(done.repeated, fine_bracket().triangles.cols());
  EXPECT_EQ(done.degenerate, 1);
  EXPECT_TRUE(mesh_faults(clean).empty());
}

TEST(MeshCleaning, KeepsTrianglesWithoutAreaThatCloseIt) {
  // The middle of an edge is a vertex of one of its triangles only: a sliver closes the gap.
  TriangleMesh mesh = Box(Vector3d::Ones()).surface();
  const Eigen::Vector3i first = mesh.triangles.col(0);
  mesh.vertices.conservativeResize(3, 9);
  mesh.vertices.col(8) = 0.5 * (mesh.vertices.col(first[0]) + mesh.vertices.col(first[1]));
  mesh.triangles.col(0) << first[0], 8, first[2];
  mesh = with_triangle(mesh, 8, first[1], first[2]);
  mesh = with_triangle(mesh, first[0], first[1], 8);
  MeshCleaning done;
  const TriangleMesh clean = clean_mesh(mesh, done);
  EXPECT_EQ(clean.triangles.cols(), mesh.triangles.cols());
  EXPECT_EQ(count_edges(clean, 2, 2), 3 * mesh.triangles.cols() / 2);
}

TEST(TurnOutward, TurnsClosedShellsByTheirVolume) {
  TriangleMesh mesh = joined_meshes(with_turned(fine_bracket(), 1.0, 1),
                                    moved(fine_bracket(), Vector3d(2.0, 0.0, 0.0)));
  EXPECT_EQ(turn_outward(mesh), 2);
  EXPECT_NEAR(signed_volume(mesh), 2.0 * 0.4 * 0.64, 1e-12);
}

TEST(TurnOutward, LeavesACavityHollow) {
  TriangleMesh inner = Box(Vector3d(0.5, 0.5, 0.5)).surface();
  inner.triangles.row(0).swap(inner.triangles.row(1));
  TriangleMesh hollow = joined_meshes(Box(Vector3d::Ones()).surface(), inner);
  TriangleMesh turned = with_turned(hollow, 1.0, 1);
  turn_outward(hollow);
  turn_outward(turned);
  EXPECT_NEAR(signed_volume(hollow), 1.0 - 0.125, 1e-12);
  EXPECT_NEAR(signed_volume(turned), 1.0 - 0.125, 1e-12);
}

TEST(TurnOutward, TurnsOpenPiecesByWhatTheySee) {
  // Six sides that hang together nowhere.
  TriangleMesh sides;
  const TriangleMesh box = Box(Vector3d::Ones()).surface();
  for (int side = 0; side < 6; ++side) {
    TriangleMesh one = box;
    one.triangles = Eigen::Matrix3Xi(box.triangles.middleCols(2 * side, 2));
    if (side % 2 == 0) one.triangles.row(0).swap(one.triangles.row(1));
    one.vertices *= 1.0 + 0.001 * side;
    sides = side == 0 ? one : joined_meshes(sides, one);
  }
  turn_outward(sides);
  for (const auto t : sides.triangles.colwise()) {
    const Vector3d a = sides.vertices.col(t[0]), b = sides.vertices.col(t[1]),
                   c = sides.vertices.col(t[2]);
    EXPECT_GT((b - a).cross(c - a).dot(a + b + c), 0.0);
  }
}

TEST(GeneralizedWinding, IsThatOfRaysForAClosedMesh) {
  const TriangleMesh mesh = fine_bracket();
  const GeneralizedWinding winding(mesh);
  const WindingCount exact(mesh);
  std::mt19937 random(3);
  for (int k = 0; k < 3000; ++k) {
    Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = 1.4 * (random() / 4294967296.0) - 0.2;
    EXPECT_NEAR(winding(p), exact(p), 0.05) << p.transpose();
  }
}

TEST(GeneralizedWinding, IsOneHalfInTheMiddleOfAHole) {
  TriangleMesh open = Box(Vector3d::Ones()).surface();
  std::vector<int> kept;
  for (int t = 0; t < 12; ++t) {
    double z = 0.0;
    for (const int v : open.triangles.col(t)) z += open.vertices(2, v);
    if (z < 1.4) kept.push_back(t);
  }
  ASSERT_EQ(kept.size(), 10u);
  open.triangles = Eigen::Matrix3Xi(open.triangles(Eigen::all, kept));
  const GeneralizedWinding winding(open);
  EXPECT_NEAR(winding({0.0, 0.0, 0.5}), 0.5, 1e-6);
  EXPECT_GT(winding({0.0, 0.0, 0.0}), 0.8);
  EXPECT_LT(winding({0.0, 0.0, 1.0}), 0.3);
  EXPECT_EQ(GeneralizedWinding(TriangleMesh())({0.0, 0.0, 0.0}), 0.0);
}

TEST(ConvexHull, OfABracketIsClosedAndConvex) {
  const TriangleMesh hull = convex_hull(fine_bracket().vertices);
  validate(hull, "hull");
  EXPECT_TRUE(boundary_vertices(hull).empty());
  // The square without the corner beyond the line between the arms' ends.
  EXPECT_NEAR(signed_volume(hull), 0.4 * (1.0 - 0.5 * 0.6 * 0.6), 1e-9);
}

TEST(ConvexHull, RefusesWhatIsFlat) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Random(3, 20);
  points.row(2).setConstant(0.25);
  expect_refusal([&] { convex_hull(points); }, {"one plane"});
  expect_refusal([] { convex_hull(Eigen::Matrix3Xd::Zero(3, 9)); }, {"convex hull"});
  expect_refusal([] { convex_hull(Eigen::Matrix3Xd::Random(3, 3)); }, {"fewer than four"});
}

TEST(Isosurface, OfASphereIsClosedAndItsOwn) {
  DistanceGrid grid;
  grid.count = {24, 24, 24};
  grid.spacing = 0.1;
  grid.origin = Vector3d::Constant(-1.15);
  for (int k = 0; k < 24 * 24 * 24; ++k) {
    const Vector3d p = grid.origin + 0.1 * Vector3d(k % 24, k / 24 % 24, k / 576);
    grid.samples.push_back(static_cast<float>(p.norm() - 0.8));
  }
  const TriangleMesh mesh = isosurface(grid);
  validate(mesh, "isosurface");
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  EXPECT_NEAR(signed_volume(mesh), 4.0 / 3.0 * M_PI * 0.512, 0.03);
  grid.samples.assign(grid.samples.size(), 1.0f);
  EXPECT_EQ(isosurface(grid).triangles.cols(), 0);
}

TEST(SoundMesh, NamesAllFaultsAtOnce) {
  TriangleMesh mesh = with_triangle(with_holes(fine_bracket(), 0.04, 2), 0, 1, 200);
  mesh = with_triangle(with_triangle(mesh, 0, 1, 200), 3, 3, 4);
  const SoundMesh sound = make_sound(with_turned(mesh, 0.1, 5));
  EXPECT_FALSE(sound.closed);
  const std::string all = ::testing::PrintToString(sound.faults);
  for (const char* fault : {"open edges", "edge of more than two", "1 triangle without area",
                            "1 triangle that repeats", "turned"}) {
    EXPECT_NE(all.find(fault), std::string::npos) << fault << " is not in " << all;
  }
}

TEST(SoundMesh, ACavityIsNoOverlap) {
  TriangleMesh inner = Box(Vector3d(0.5, 0.5, 0.5)).surface();
  inner.triangles.row(0).swap(inner.triangles.row(1));
  const SoundMesh sound = make_sound(joined_meshes(Box(Vector3d::Ones()).surface(), inner));
  EXPECT_TRUE(sound.closed);
  EXPECT_FALSE(sound.overlaps);
  EXPECT_TRUE(sound.faults.empty()) << ::testing::PrintToString(sound.faults);
}

TEST(BodySurface, OfAMeshWithFaultsIsClosed) {
  const TriangleMesh broken[] = {
      with_holes(fine_bracket(), 0.04, 2), with_triangle(fine_bracket(), 0, 1, 200),
      joined_meshes(fine_bracket(), moved(fine_bracket(), Vector3d(0.05, 0.0, 0.0)))};
  for (const TriangleMesh& mesh : broken) {
    std::string note;
    const TriangleMesh closed = make_body_surface(mesh, note);
    validate(closed, "body");
    EXPECT_TRUE(boundary_vertices(closed).empty());
    EXPECT_NE(note.find("made anew"), std::string::npos) << note;
    const double width = mesh.vertices.row(0).maxCoeff();
    EXPECT_NEAR(signed_volume(closed), 0.4 * (0.64 + (width - 1.0)), 0.02);
    EXPECT_LE(closed.triangles.cols(), 21'000);
  }
}

TEST(BodySurface, LeavesAGoodMeshAndMendsWithoutNewTriangles) {
  std::string note = "nothing yet";
  EXPECT_EQ(make_body_surface(fine_bracket(), note).vertices, fine_bracket().vertices);
  EXPECT_EQ(note, "");
  const TriangleMesh closed = make_body_surface(doubled(fine_bracket()), note);
  EXPECT_EQ(closed.triangles.cols(), fine_bracket().triangles.cols());
  EXPECT_NE(note.find("repeat others"), std::string::npos) << note;
  const TriangleMesh open = with_holes(fine_bracket(), 0.01, 2);
  EXPECT_EQ(make_body_surface(open, note, true).triangles.cols(), open.triangles.cols());
}

TEST(BodySurface, RefusesASheetWithAllItsFaults) {
  TriangleMesh mesh = fine_bracket();
  mesh.triangles = Eigen::Matrix3Xi(mesh.triangles.leftCols(60));
  mesh = with_triangle(mesh, 7, 7, 8);
  std::string note;
  expect_refusal([&] { make_body_surface(mesh, note); },
                 {"bounds no solid", "open edges", "without area"});
}

}  // namespace
}  // namespace pliant
