// Geometries of the model `patch` that a scene must not have, and what it is told.
#include <gtest/gtest.h>

#include <fstream>

#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

struct GeometryCase {
  const char* geometry;
  std::vector<std::string> parts;  ///< of the message
};

std::ostream& operator<<(std::ostream& stream, const GeometryCase& given) {
  return stream << given.geometry;
}

std::string scene(const std::string& geometry) {
  return "time_step: 0.01\nbodies:\n  - name: body\n    model: patch\n    geometry: " + geometry +
         "\n    material: {young: 1e4, poisson: 0.3, density: 500}\n";
}

const char* const kVertices = "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n";

/// Writes a tetrahedron's surface in every way that it must not be.
void write_meshes(const SceneFiles& files) {
  const std::string vertices = kVertices, faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\n";
  files.write("good.obj", vertices + faces + "f 3 1 4\n");
  files.write("open.obj", vertices + faces);
  files.write("flipped.obj", vertices + "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  files.write("nan.obj", "v nan 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\n" + faces + "f 3 1 4\n");
  files.write("empty.obj", vertices);
  files.write("repeated.obj", vertices + faces + "f 3 1 4\nf 3 1 4\n");
  files.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n");
  files.write("lonely.node", "1 3 0 0\n1 0 0 0\n");
  files.write("bases.yaml", "bases: 3\n");
}

const GeometryCase kGeometryCases[] = {
    {"sphere", {":5:", "'sphere'", "a map with one of mesh, patches"}},
    {"{spere: {radius: 0.1}}", {":5:", "needs one of", "did you mean 'sphere'?"}},
    {"{tetrahedra: 300}", {":5:", "needs one of"}},
    {"{sphere: {radius: 0.1}, block: {size: [1, 1, 1], cells: [1, 1, 1]}}",
     {":5:", "'sphere' and 'block'", "give one"}},
    {"{grid: {size: [1, 1], vertices: [3, 3]}}", {":5:", "does not work for model 'patch'"}},
    {"{sphere: 0.1}", {":5:", "geometry.sphere", "radius"}},
    {"{sphere: {radius: 0}}", {":5:", "'radius' is '0'", "> 0", "[m]"}},
    {"{sphere: {radus: 0.1}}", {":5:", "'radus'", "did you mean 'radius'?"}},
    {"{sphere: {radius: 0.1}, tetrahedra: 0}", {":5:", "'tetrahedra' is '0'", ">= 1"}},
    {"{sphere: {radius: 0.1}, tetrahdra: 9}", {":5:", "did you mean 'tetrahedra'?"}},
    {"{sphere: {radius: 0.1}, contact_spacing: 1e-7}", {":5:", "body", "1e-07 m", "10000000"}},
    {"{torus: {ring: 0.1, tube: 0.2}}", {":5:", "tube is 0.2 m", "less than ring, 0.1 m"}},
    {"{rounded_box: {size: [1, 1, 1], radius: 0.7}}", {":5:", "radius is 0.7 m", "0.4995"}},
    {"{block: {size: [1, 1, 1], cells: [2.5, 1, 1]}}", {":5:", "2.5, 1, 1", "whole numbers"}},
    {"{block: {size: [1, 1, 1], cells: [0, 1, 1]}}", {":5:", "cells along x are 0", "1 or more"}},
    {"{block: {size: [1, 0, 1], cells: [1, 1, 1]}}", {":5:", "size along y is 0 m"}},
    {"{mesh: missing.obj}", {":5:", "missing.obj", "no such file"}},
    {"{mesh: {a: 1}}", {":5:", "geometry.mesh is a map", "a text"}},
    {"{mesh: good.obj, scale: 0}", {":5:", "'scale' is '0'"}},
    {"{mesh: good.obj, cell_size: 1}", {":5:", "cell_size is 1 m", "allowed is"}},
    {"{mesh: open.obj}", {":5:", "open.obj", "the surface is open", "vertex 0", "0.1 m wide"}},
    {"{mesh: nan.obj}", {":5:", "nan.obj", "not finite"}},
    {"{mesh: empty.obj}", {":5:", "empty.obj", "no faces"}},
    {"{mesh: flat.obj}", {":5:", "flat.obj"}},
    {"{tetrahedral_mesh: missing.msh}", {":5:", "missing.msh", "no such file"}},
    {"{tetrahedral_mesh: lonely.node}", {":5:", "lonely.ele", "no such file"}},
    {"{tetrahedral_mesh: missing.veg}", {":5:", "missing.veg", "no such file"}},
    {"{patches: bases.yaml}", {":5:", "bases.yaml:1", "'bases'", "vertices, triangles, edges"}},
};

class GeometryRefusal : public testing::TestWithParam<GeometryCase> {};

TEST_P(GeometryRefusal, SaysWhatWhereAndWhatIsAllowed) {
  const SceneFiles files;
  write_meshes(files);
  const std::string path = files.write("scene.yaml", scene(GetParam().geometry));
  expect_refusal([&] { load_scene(path); }, GetParam().parts);
}

INSTANTIATE_TEST_SUITE_P(Cases, GeometryRefusal, testing::ValuesIn(kGeometryCases));

TEST(GeometryRefusal, TheSameWithoutTheFaultIsTaken) {
  const SceneFiles files;
  write_meshes(files);
  const LoadedScene loaded =
      load_scene(files.write("scene.yaml", scene("{mesh: good.obj, tetrahedra: 100}")));
  EXPECT_TRUE(loaded.world->step());
  EXPECT_EQ(loaded.world->bodies().front().report.solver, "newton") << "the model's default";
  EXPECT_TRUE(loaded.notes.empty());
}

TEST(GeometryRefusal, TheMaterialOfAFileCountsWhereTheSceneSaysNone) {
  const SceneFiles files;
  files.write("body.veg",
              "*VERTICES\n4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n*ELEMENTS\nTET\n1 4 0\n"
              "1 1 2 3 4\n*MATERIAL m\nENU, 600, 5e4, 0.4\n*REGION\nallElements, m\n");
  const auto mass = [&](const std::string& text) {
    const LoadedScene loaded = load_scene(files.write("scene.yaml", text));
    EXPECT_EQ(loaded.mended_meshes, 0);
    EXPECT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find("file's material 'm'"), std::string::npos) << loaded.notes[0];
    EXPECT_TRUE(loaded.world->step());
    return loaded.world->bodies().front().model->particles().mass.sum();
  };
  const std::string text = replaced(scene("{tetrahedral_mesh: body.veg}"),
                                    "    material: {young: 1e4, poisson: 0.3, density: 500}\n", "");
  EXPECT_NEAR(mass(text), 600.0 / 6.0, 1e-10);
  EXPECT_NEAR(mass(text + "    material: {density: 300}\n"), 300.0 / 6.0, 1e-10);
}

TEST(GeometryRefusal, WhatCanBeMendedIsMendedAndNoted) {
  const SceneFiles files;
  write_meshes(files);
  for (const auto& [name, fault] : {std::pair("flipped.obj", "4 triangles turned"),
                                    std::pair("repeated.obj", "1 triangle that repeats")}) {
    const std::string geometry = std::string("{mesh: ") + name + ", tetrahedra: 100}";
    const LoadedScene loaded = load_scene(files.write("scene.yaml", scene(geometry)));
    ASSERT_EQ(loaded.notes.size(), 1u);
    EXPECT_NE(loaded.notes[0].find(fault), std::string::npos) << loaded.notes[0];
    EXPECT_EQ(loaded.mended_meshes, 1);
  }
}

}  // namespace
}  // namespace pliant
