// What a scene says of bodies that begin within something that is not deformed.
#include <gtest/gtest.h>

#include "support/worlds/body_pairs.h"

namespace pliant::start_in_obstacles_test {
namespace {

/// The warnings of a block with its lower side 10 mm within, on or above a plate, as `height` says.
std::vector<std::string> warnings_at(double height, const std::string& model = "patch",
                                     const std::string& effects = "contact: {}",
                                     const std::string& plate = "") {
  const SceneFiles files;
  const std::string text = "time_step: 0.005\nbodies:\n" + slab("block", model, height) +
                           "obstacles:\n  - {name: plate, shape: box, size: [1, 1, 0.1], position: "
                           "[0, 0, -0.05]" +
                           plate + "}\neffects: {gravity: {}, " + effects + "}\n";
  return load_scene(files.write("scene.yaml", text)).warnings;
}

bool tells(const std::vector<std::string>& warnings) {
  return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return has(warning, "body 'block' starts inside obstacle 'plate': ");
  });
}

TEST(StartInObstacles, ABodyThatBeginsInsideIsNamedWithItsDepth) {
  for (const std::string model : {"patch", "rigid", "cloth"}) {
    EXPECT_TRUE(tells(warnings_at(-0.01, model))) << model;
    EXPECT_FALSE(tells(warnings_at(0.2, model))) << model;
  }
  const std::vector<std::string> warnings = warnings_at(-0.01, "cloth");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings[0], "vertices are up to 10 mm deep")) << warnings[0];
}

TEST(StartInObstacles, WhatOnlyTouchesIsNot) {
  EXPECT_TRUE(warnings_at(0.0, "cloth").empty());
  EXPECT_TRUE(warnings_at(-1e-5, "cloth").empty());
}

TEST(StartInObstacles, LiquidsAndScenesWithoutContactAreNot) {
  EXPECT_FALSE(tells(warnings_at(-0.01, "cloth", "damping: {}")));
  EXPECT_FALSE(tells(warnings_at(-0.01, "cloth", "contact: {}", ", liquid: true")));
}

}  // namespace
}  // namespace pliant::start_in_obstacles_test
