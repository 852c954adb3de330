#include "pliant/geometry/repair/mesh_collider.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

#include "pliant/geometry/mesh/grid.h"
#include "support/expect_refusal.h"
#include "support/meshes/broken_meshes.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

ColliderOptions of_kind(ColliderKind kind, double voxel_size = 0.0) {
  ColliderOptions options;
  options.kind = kind;
  options.voxel_size = voxel_size;
  return options;
}

bool says(const MeshCollider& collider, const std::string& part) {
  return collider.note.find(part) != std::string::npos;
}

struct Broken {
  const char* name;
  std::function<TriangleMesh()> make;
  ColliderKind kind;
  const char* note;
};

std::ostream& operator<<(std::ostream& out, const Broken& broken) { return out << broken.name; }

const Broken kBroken[] = {
    {"Whole", [] { return fine_bracket(); }, ColliderKind::kExact, "exact"},
    {"AllTurned", [] { return with_turned(fine_bracket(), 1.0, 1); }, ColliderKind::kExact,
     "triangles turned"},
    {"SomeTurned", [] { return with_turned(fine_bracket(), 0.2, 1); }, ColliderKind::kExact,
     "triangles turned"},
    {"Doubled", [] { return doubled(fine_bracket()); }, ColliderKind::kExact, "that repeat others"},
    {"Unwelded", [] { return torn(fine_bracket(), 0.0, 1); }, ColliderKind::kExact, "exact"},
    {"Cracked", [] { return torn(fine_bracket(), 2e-6, 1); }, ColliderKind::kExact,
     "vertices joined"},
    {"Torn", [] { return torn(fine_bracket(), 1e-3, 1); }, ColliderKind::kRepaired, "open edges"},
    {"Holes", [] { return with_holes(fine_bracket(), 0.04, 2); }, ColliderKind::kRepaired,
     "closes holes"},
    {"HolesAndTurned", [] { return with_turned(with_holes(fine_bracket(), 0.03, 3), 0.2, 4); },
     ColliderKind::kRepaired, "closes holes"},
    {"Fin", [] { return with_triangle(fine_bracket(), 0, 1, 200); }, ColliderKind::kRepaired,
     "edge of more than two triangles"},
    {"WallWithin", [] { return with_wall(fine_bracket()); }, ColliderKind::kRepaired, "open edges"},
    {"SheetOutside", [] { return with_sheet(fine_bracket()); }, ColliderKind::kRepaired,
     "of the mesh bounds nothing"},
    {"HolesAndSheet", [] { return with_sheet(with_holes(fine_bracket(), 0.03, 2)); },
     ColliderKind::kRepaired, "closes holes"},
    {"AllOfThese",
     [] {
       return doubled(
           with_turned(with_sheet(with_wall(with_holes(fine_bracket(), 0.03, 2))), 0.2, 4));
     },
     ColliderKind::kRepaired, "that repeat others"},
};

class BrokenBracket : public ::testing::TestWithParam<Broken> {};

TEST_P(BrokenBracket, IsWithinAVoxelOfTheWhole) {
  const MeshCollider collider = make_mesh_collider(GetParam().make());
  EXPECT_EQ(collider.kind, GetParam().kind) << collider.note;
  EXPECT_TRUE(says(collider, GetParam().note)) << collider.note;
  const double voxel = collider.shape->voxel_size();
  EXPECT_NEAR(voxel, 1.0 / 64.0, 1e-4);
  const WholeDistance whole(fine_bracket());
  EXPECT_LT(greatest_error(*collider.shape, whole, 3.0 * voxel, 20'000), voxel);
}

INSTANTIATE_TEST_SUITE_P(Table, BrokenBracket, ::testing::ValuesIn(kBroken),
                         [](const auto& info) { return info.param.name; });

TEST(MeshCollider, SpheresThatPassThroughEachOtherAreTheirUnion) {
  const TriangleMesh sphere = Sphere(0.5).surface();
  const Vector3d apart(0.6, 0.0, 0.0);
  const MeshCollider collider = make_mesh_collider(joined_meshes(sphere, moved(sphere, apart)));
  EXPECT_EQ(collider.kind, ColliderKind::kRepaired);
  EXPECT_TRUE(says(collider, "its 2 shells overlap")) << collider.note;
  // Of two spheres: the nearest point of a sphere counts unless it is within the other one; then
  // the circle in which both meet is the nearest.
  const double ring = std::sqrt(0.25 - 0.09);
  const auto of_union = [&](const Vector3d& p) {
    double nearest = std::hypot(p[0] - 0.3, std::hypot(p[1], p[2]) - ring);
    for (const Vector3d& center : {Vector3d(0, 0, 0), apart}) {
      const Vector3d other = apart - center;
      const Vector3d on = center + 0.5 * (p - center).normalized();
      if ((on - other).norm() >= 0.5) nearest = std::min(nearest, (p - on).norm());
    }
    const bool inside = p.norm() < 0.5 || (p - apart).norm() < 0.5;
    return inside ? -nearest : nearest;
  };
  const double voxel = collider.shape->voxel_size();
  EXPECT_LT(greatest_error(*collider.shape, of_union, 3.0 * voxel, 20'000), voxel);
}

TEST(MeshCollider, BarsThatCrossHaveNoWallsInside) {
  const TriangleMesh bars =
      joined_meshes(Box(Vector3d(1.0, 0.2, 0.2)).surface(), Box(Vector3d(0.2, 1.0, 0.2)).surface());
  const MeshCollider collider = make_mesh_collider(bars);
  EXPECT_EQ(collider.kind, ColliderKind::kRepaired) << collider.note;
  // The sides z = 0.1 are 0.1 m away; walls of the other bar were nearer.
  EXPECT_NEAR(collider.shape->distance({0.09, 0.0, 0.0}), -0.1, collider.shape->voxel_size());
  EXPECT_NEAR(collider.shape->distance({0.0, 0.09, 0.0}), -0.1, collider.shape->voxel_size());
}

TEST(MeshCollider, PartsThatShareEdgesAndMissTrianglesKeepTheirInside) {
  // Where both meet, edges have up to four triangles, and two of different parts where two miss.
  const TriangleMesh one = fine_bracket(), other = moved(one, Vector3d(0.2, -0.3, 0.1));
  const TriangleMesh all = with_turned(with_holes(joined_meshes(one, other), 0.05, 5), 0.1, 6);
  const MeshCollider collider = make_mesh_collider(all);
  EXPECT_EQ(collider.kind, ColliderKind::kRepaired) << collider.note;
  const WholeDistance to_one(one), to_other(other);
  const double clear = 2.0 * collider.shape->voxel_size();
  std::mt19937 random(11);
  for (int k = 0; k < 5000; ++k) {
    Vector3d p;
    for (int i = 0; i < 3; ++i) p[i] = 1.6 * (random() / 4294967296.0) - 0.4;
    const double a = to_one(p), b = to_other(p);
    if (std::min(std::abs(a), std::abs(b)) < clear) continue;
    EXPECT_EQ(collider.shape->distance(p) < 0.0, std::min(a, b) < 0.0) << p.transpose();
  }
}

TEST(MeshCollider, WhatIsDrawnIsClosedAndEnclosesTheSolid) {
  for (const TriangleMesh& mesh : {with_holes(fine_bracket(), 0.04, 2), fine_bracket()}) {
    const MeshCollider collider = make_mesh_collider(mesh);
    const TriangleMesh surface = collider.shape->surface();
    EXPECT_TRUE(boundary_vertices(surface).empty());
    EXPECT_NEAR(signed_volume(surface), 0.4 * 0.64, 0.01);
    EXPECT_NEAR(collider.shape->bounds().max().x(), 1.0, collider.shape->voxel_size());
  }
}

TEST(MeshCollider, ACleanMeshHasTheSamplesOfItsShape) {
  const MeshCollider collider = make_mesh_collider(fine_bracket());
  EXPECT_EQ(collider.note, "exact");
  EXPECT_EQ(collider.shape->grid().samples, MeshShape(fine_bracket()).grid().samples);
}

TEST(MeshCollider, AnyNumberOfThreadsGivesTheSameBits) {
  const TriangleMesh mesh = with_holes(fine_bracket(), 0.04, 2);
  for (const ColliderKind kind : {ColliderKind::kRepaired, ColliderKind::kThickShell}) {
    std::vector<float> serial;
    {
      const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
      serial = make_mesh_collider(mesh, of_kind(kind, 0.04)).shape->grid().samples;
    }
    for (const std::size_t threads : {2, 5}) {
      const tbb::global_control some(tbb::global_control::max_allowed_parallelism, threads);
      EXPECT_EQ(make_mesh_collider(mesh, of_kind(kind, 0.04)).shape->grid().samples, serial);
    }
  }
}

TEST(MeshCollider, AnOpenSheetBecomesAThickShell) {
  const MeshCollider collider = make_mesh_collider(make_grid({1.0, 0.5, 5, 5}));
  EXPECT_EQ(collider.kind, ColliderKind::kThickShell) << collider.note;
  EXPECT_TRUE(says(collider, "31 mm thick")) << collider.note;
  EXPECT_TRUE(says(collider, "open edges")) << collider.note;
  const double voxel = collider.shape->voxel_size();
  EXPECT_NEAR(collider.shape->distance({0.0, 0.0, 0.05}), 0.05 - voxel, 0.1 * voxel);
  EXPECT_NEAR(collider.shape->distance({0.0, 0.0, 0.0}), -voxel, 0.6 * voxel);
}

TEST(MeshCollider, APlateThinnerThanItsSamplesBecomesAThickShell) {
  const MeshCollider collider = make_mesh_collider(Box(Vector3d(1.0, 1.0, 1e-4)).surface());
  EXPECT_EQ(collider.kind, ColliderKind::kThickShell);
  EXPECT_TRUE(says(collider, "thinner than its samples")) << collider.note;
  EXPECT_LT(collider.shape->distance({0.1, 0.1, 0.0}), 0.0);
  // A thicker one is sampled finer instead.
  const MeshCollider finer = make_mesh_collider(Box(Vector3d(1.0, 1.0, 0.015)).surface());
  EXPECT_EQ(finer.kind, ColliderKind::kExact);
  EXPECT_LT(finer.shape->distance({0.1, 0.1, 0.0}), 0.0);
}

/// The lower part of a sphere, open above z = `top`.
TriangleMesh bowl(double top) {
  const TriangleMesh sphere = Sphere(0.5).surface();
  std::vector<int> kept;
  for (int t = 0; t < sphere.triangles.cols(); ++t) {
    double z = 0.0;
    for (const int v : sphere.triangles.col(t)) z += sphere.vertices(2, v) / 3.0;
    if (z < top) kept.push_back(t);
  }
  return {sphere.vertices, sphere.triangles(Eigen::all, kept)};
}

TEST(MeshCollider, AWideOpeningIsClosedOnlyWhereItIsASmallPart) {
  const MeshCollider small = make_mesh_collider(bowl(0.3));
  EXPECT_EQ(small.kind, ColliderKind::kRepaired) << small.note;
  EXPECT_NEAR(small.shape->distance({0.0, 0.0, 0.2}), -0.1, 2.0 * small.shape->voxel_size());
  // Half a sphere has a third of its closed surface to close: its hull is the same solid.
  const MeshCollider half = make_mesh_collider(bowl(0.0));
  EXPECT_EQ(half.kind, ColliderKind::kConvex) << half.note;
  EXPECT_NEAR(half.shape->distance({0.0, 0.0, -0.1}), -0.1, 2.0 * half.shape->voxel_size());
  // A hollow that the hull would fill stays one.
  TriangleMesh sides = fine_bracket();
  std::vector<int> upright;
  for (int t = 0; t < sides.triangles.cols(); ++t) {
    const Vector3d a = sides.vertices.col(sides.triangles(0, t)),
                   b = sides.vertices.col(sides.triangles(1, t)),
                   c = sides.vertices.col(sides.triangles(2, t));
    if (std::abs((b - a).cross(c - a).normalized().z()) < 0.5) upright.push_back(t);
  }
  sides.triangles = Eigen::Matrix3Xi(sides.triangles(Eigen::all, upright));
  EXPECT_EQ(make_mesh_collider(sides).kind, ColliderKind::kThickShell);
}

TEST(MeshCollider, EachKindCanBeAskedFor) {
  const TriangleMesh mesh = fine_bracket();
  const Vector3d corner(0.6, 0.6, 0.2);  // between the arms
  EXPECT_GT(make_mesh_collider(mesh, of_kind(ColliderKind::kExact)).shape->distance(corner), 0.15);
  EXPECT_GT(make_mesh_collider(mesh, of_kind(ColliderKind::kRepaired)).shape->distance(corner),
            0.15);
  const MeshCollider convex = make_mesh_collider(mesh, of_kind(ColliderKind::kConvex));
  EXPECT_EQ(convex.kind, ColliderKind::kConvex);
  EXPECT_LT(convex.shape->distance(corner), -0.1);
  ColliderOptions shell = of_kind(ColliderKind::kThickShell);
  shell.thickness = 0.1;
  const MeshCollider hollow = make_mesh_collider(mesh, shell);
  EXPECT_EQ(hollow.kind, ColliderKind::kThickShell);
  EXPECT_NEAR(hollow.shape->distance({0.2, 0.2, 0.2}), 0.2 - 0.05, 0.02);  // it is hollow
  EXPECT_NEAR(hollow.shape->distance({0.5, 0.2, 0.45}), 0.0, 0.01);
}

TEST(MeshCollider, RefusesAKindThatIsNotToBeHad) {
  const auto refused = [](const TriangleMesh& mesh, ColliderKind kind,
                          const std::vector<std::string>& parts) {
    expect_refusal([&] { make_mesh_collider(mesh, of_kind(kind)); }, parts);
  };
  TriangleMesh worse = with_triangle(with_holes(fine_bracket(), 0.04, 2), 0, 1, 200);
  worse = joined_meshes(worse, worse);
  refused(worse, ColliderKind::kExact,
          {"collider 'exact' needs a closed surface", "open edges", "more than two triangles",
           "triangles that repeat others"});
  const TriangleMesh sheet = make_grid({1.0, 0.5, 5, 5});
  refused(sheet, ColliderKind::kExact, {"open edges"});
  refused(sheet, ColliderKind::kRepaired, {"no inside", "open edges", "thick_shell"});
  refused(sheet, ColliderKind::kConvex, {"convex hull", "one plane"});
  refused(Box(Vector3d(1, 1, 1e-4)).surface(), ColliderKind::kExact, {"no inside", "voxel_size"});
}

TEST(MeshCollider, RefusesMeshesWithoutAnArea) {
  expect_refusal([] { make_mesh_collider(TriangleMesh()); }, {"no vertices"});
  TriangleMesh bad = fine_bracket();
  bad.vertices(0, 3) = std::nan("");
  bad.triangles(0, 0) = 7777;
  expect_refusal([&] { make_mesh_collider(bad); }, {"not finite: 3", "name vertices outside"});
  TriangleMesh line;
  line.vertices.resize(3, 3);
  line.vertices << 0, 1, 2, 0, 0, 0, 0, 0, 0;
  line.triangles.resize(3, 1);
  line.triangles << 0, 1, 2;
  expect_refusal([&] { make_mesh_collider(line); }, {"none of its triangles has an area"});
}

TEST(MeshCollider, RefusesOptionsOutOfRange) {
  for (const double bad : {-0.1, 1.5, std::nan("")}) {
    ColliderOptions options;
    options.thickness = bad;
    expect_refusal([&] { make_mesh_collider(fine_bracket(), options); }, {"thickness", "(0, 1]"});
    options = of_kind(ColliderKind::kAuto, bad);
    expect_refusal([&] { make_mesh_collider(fine_bracket(), options); }, {"voxel_size"});
  }
}

TEST(MeshCollider, NamesAreThoseOfScenes) {
  for (const std::string& name : collider_names()) {
    EXPECT_EQ(collider_name(find_collider(name)), name);
  }
  expect_refusal([] { find_collider("convx"); }, {"collider", "convx", "convex"});
}

}  // namespace
}  // namespace pliant
