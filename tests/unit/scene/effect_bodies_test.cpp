// Effects that name the bodies that they act on.
#include <gtest/gtest.h>

#include "support/worlds/body_pairs.h"

namespace pliant::effect_bodies_test {
namespace {

std::string two_cloths_and_a_box(const std::string& effects) {
  return scene_text(
      {slab("towel", "cloth", 0.1), slab("napkin", "cloth", 0.2), slab("box", "rigid", 0.3)},
      effects);
}

TEST(EffectBodies, ActsOnThoseThatItNamesAndElseOnAll) {
  const SceneFiles files;
  const auto acts_on = [&](const std::string& effects) {
    const LoadedScene scene = load_scene(files.write("scene.yaml", two_cloths_and_a_box(effects)));
    std::string names;
    for (const Body& body : scene.world->bodies()) {
      if (body.find_effect("strain_limit") != nullptr) names += body.name + " ";
    }
    return names;
  };
  EXPECT_EQ(acts_on("  strain_limit: {max: 1.02, bodies: [towel]}\n"), "towel ");
  EXPECT_EQ(acts_on("  strain_limit: {max: 1.02, bodies: [napkin, towel]}\n"), "towel napkin ");
  EXPECT_EQ(acts_on("  strain_limit: {max: 1.02}\n"), "towel napkin ");
}

TEST(EffectBodies, WhatItCannotActOnIsRefused) {
  const std::pair<const char*, std::vector<const char*>> all[] = {
      {"[towl]",
       {"scene.yaml:", "effects.strain_limit.bodies: unknown body 'towl'",
        "did you mean 'towel'?"}},
      {"[towel, towel]", {"body 'towel' is named twice"}},
      {"[box]", {"effect 'strain_limit' is not made for the model 'rigid' of body 'box'"}},
      {"[]", {"effects.strain_limit.bodies is an empty list"}},
      {"towel", {"effects.strain_limit.bodies is 'towel', but must be a list"}}};
  for (const auto& [bodies, parts] : all) {
    const std::string text =
        refusal(two_cloths_and_a_box(std::string("  strain_limit: {bodies: ") + bodies + "}\n"));
    for (const char* part : parts) EXPECT_TRUE(has(text, part)) << bodies << "\n" << text;
  }
}

// Bodies of particles are moved as one.
TEST(EffectBodies, NoneOfThoseThatAreMovedAsOneIsLeftOut) {
  const std::string text = refusal(scene_text(
      {slab("a", "viscoelastic", 0.1), slab("b", "viscoelastic", 0.3)}, "  heat: {bodies: [b]}\n"));
  EXPECT_TRUE(has(text, "effects.heat.bodies leaves out 'a'")) << text;
}

}  // namespace
}  // namespace pliant::effect_bodies_test
