#include "pliant/scene/reading/patch_file.h"

#include <gtest/gtest.h>

#include "pliant/geometry/patch/patch_polygons.h"
#include "pliant/geometry/patch/patch_shapes.h"
#include "support/expect_refusal.h"
#include "support/worlds/patch_bodies.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

void expect_same(const PatchBody& a, const PatchBody& b) {
  EXPECT_EQ(a.base.vertices, b.base.vertices);
  EXPECT_EQ(a.base.triangles, b.base.triangles);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.quadrics, b.quadrics);
  EXPECT_EQ(a.dents, b.dents);
}

TEST(PatchFile, WhatIsWrittenIsReadBackBitForBit) {
  const SceneFiles files;
  PatchBody figure = three_patches();
  figure.dents = false;
  for (const PatchBody& body : {figure, make_torus_patches(0.1, 0.03)}) {
    write_patch_body(files.path("body.yaml"), body);
    expect_same(read_patch_body(files.path("body.yaml")), body);
  }
}

TEST(PatchFile, EdgesMayStandInAnyOrderAndWay) {
  const PatchBody body = three_patches();
  std::string text = patch_body_text(body);
  const auto edges_at = text.find("edges:\n") + 7;
  std::vector<std::string> lines;
  std::istringstream rest(text.substr(edges_at));
  for (std::string line; std::getline(rest, line);) lines.insert(lines.begin(), line);
  std::string reversed = text.substr(0, edges_at);
  for (const std::string& line : lines) reversed += line + "\n";
  const std::string old = "vertices: [0, 1]";
  reversed.replace(reversed.find(old), old.size(), "vertices: [1, 0]");
  expect_same(parse_patch_body(reversed, "a.yaml"), body);
}

TEST(PatchFile, TheFigureOfThreePatchesIsThere) {
  const PatchBody body =
      read_patch_body(std::string(PLIANT_SOURCE_DIR) + "/config/patches/three_patches.yaml");
  EXPECT_EQ(body.base.triangles.cols(), 3);
  EXPECT_FALSE(body.dents);
  const PatchSurface surface(body);
  EXPECT_NO_THROW(validate(polygonise(surface, 16).mesh, "figure"));
  for (int patch = 0; patch < 3; ++patch) {
    const Eigen::Vector3d middle = Eigen::Vector3d::Constant(1.0 / 3.0);
    Eigen::Vector3d flat = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      flat += body.base.vertices.col(body.base.triangles(k, patch)) / 3.0;
    }
    EXPECT_GT((surface.point(patch, middle) - flat).norm(), 0.05);  // a bulge to be seen
  }
}

TEST(PatchFile, BadFilesAreRefusedWithFileAndLine) {
  const std::string good = patch_body_text(three_patches());
  const auto refuse = [&](const std::string& old, const std::string& other,
                          std::vector<std::string> parts) {
    std::string text = good;
    const auto at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    text.replace(at, old.size(), other);
    parts.push_back("body.yaml");
    expect_refusal([&] { parse_patch_body(text, "body.yaml"); }, parts);
  };
  refuse("dents: true", "dent: true", {":1", "unknown key 'dent'", "did you mean 'dents'"});
  refuse("dents: true", "dents: maybe", {":1", "dents"});
  refuse("vertices:\n", "points:\n", {"unknown key 'points'"});
  refuse("[0, 0, 0.4]", "[0, 0]", {":3", "vertices[0] has 2 items", "[x, y, z]"});
  refuse("[0, 0, 0.4]", "[0, .nan, 0.4]", {":3", "vertices[0]"});
  refuse("[0, 0, 0.4]", "[0, left, 0.4]", {":3", "left"});
  refuse("- [0, 1, 2]", "- [0, 1, 4]", {":8", "triangles[0]", "[0, 3]"});
  refuse("- [0, 1, 2]", "- [0, 1, 1.5]", {":8", "triangles[0]"});
  refuse("- [0, 1, 2]", "- [0, 2, 1]", {"wind the other way"});
  refuse("vertices: [0, 1]", "vertices: [0, 0]", {"edges[0].vertices", "ends of an edge"});
  refuse("vertices: [0, 1]", "vertices: [0, 2]", {"edges[1].vertices", "no quadric yet"});
  refuse("quadric: [", "quadric: [1, ", {"edges[0].quadric has 11 items"});
  const std::string last = good.substr(good.rfind("- {"));
  refuse(last, "", {"lacks a quadric for the edge of vertices 2 and 3"});
  expect_refusal([] { parse_patch_body("", "a.yaml"); }, {"a.yaml"});
  expect_refusal([] { read_patch_body("/none.yaml"); }, {"/none.yaml"});
}

TEST(PatchFile, AnyPrefixIsRefused) {
  const std::string good = patch_body_text(three_patches());
  // Without its last line break alone, a file is whole.
  for (std::size_t size = 0; size + 1 < good.size(); size += 3) {
    EXPECT_THROW(parse_patch_body(good.substr(0, size), "cut.yaml"), InputError) << size;
  }
}

}  // namespace
}  // namespace pliant
