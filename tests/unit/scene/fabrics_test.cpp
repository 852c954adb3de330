#include "pliant/scene/reading/fabrics.h"

#include <gtest/gtest.h>

#include <set>

#include "pliant/models/registry.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

const std::string kPlain = "areal_density: 0.2, stretch_warp: 100";

ParameterText material_of(const std::string& text) {
  const SceneFiles files;
  return read_scene(write_scene(files, replaced(kFullScene, kPlain, text)))
      .bodies[0]
      .model.parameters;
}

TEST(Fabrics, AreEightAtLeastWithSourcesAndFullMaterials) {
  ASSERT_GE(fabrics().size(), 8u);
  std::set<std::string> names;
  for (const Fabric& fabric : fabrics()) {
    EXPECT_TRUE(names.insert(fabric.name).second) << fabric.name;
    EXPECT_FALSE(fabric.source.empty());
    for (const char* key : {"areal_density", "stretch_warp", "stretch_weft", "shear",
                            "bending_warp", "bending_weft"}) {
      EXPECT_EQ(fabric.parameters.count(key), 1u) << fabric.name << ' ' << key;
    }
    EXPECT_NO_THROW(parse_parameters(model_registry().find("cloth").parameters, fabric.parameters,
                                     fabric.name));
  }
}

TEST(Fabrics, GiveAScenesMaterialAndYieldToWhatItSays) {
  const ParameterText plain = material_of("fabric: black_denim");
  EXPECT_EQ(plain, find_fabric("black_denim").parameters);
  ParameterText own = material_of("fabric: black_denim, shear: 7");
  EXPECT_EQ(own.at("shear"), "7");
  own["shear"] = plain.at("shear");
  EXPECT_EQ(own, plain);
  const ParameterText bent = material_of("fabric: black_denim, bending: 1.0e-3");
  EXPECT_EQ(bent.at("bending"), "1.0e-3");
  EXPECT_EQ(bent.count("bending_warp"), 0u);
}

TEST(Fabrics, ReachTheCloth) {
  const SceneFiles files;
  const LoadedScene scene =
      load_scene(write_scene(files, replaced(kFullScene, kPlain, "fabric: black_denim")));
  EXPECT_NEAR(scene.world->bodies()[0].particles().mass.sum(), 0.324 * 2.0, 1e-12);
}

TEST(Fabrics, RefuseUnknownNames) {
  expect_refusal([] { material_of("fabric: black_denin"); },
                 {":12", "bodies[0].material.fabric", "did you mean 'black_denim'?"});
  expect_refusal([] { material_of("fabric: [black_denim]"); }, {":12", "fabric"});
  expect_refusal([] { material_of("fabric: black_denim, shaer: 1"); },
                 {":12", "did you mean 'shear'?"});
}

}  // namespace
}  // namespace pliant
