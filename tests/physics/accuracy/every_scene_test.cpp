// Every scene of config/scenes runs, and nothing passes: by a search that shares no code with the
// contacts.
#include <gtest/gtest.h>

#include <filesystem>

#include "pliant/scene/scene.h"
#include "support/meshes/passes.h"

namespace pliant::every_scene_test {
namespace {

std::vector<std::string> scenes() {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(PLIANT_SOURCE_DIR) + "/config/scenes")) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Config, EveryScene, testing::ValuesIn(scenes()),
                         [](const auto& info) { return info.param; });

TEST_P(EveryScene, BeginsWithoutPasses) {
  const LoadedScene scene =
      load_scene(std::string(PLIANT_SOURCE_DIR) + "/config/scenes/" + GetParam() + ".yaml");
  for (const std::string& warning : scene.warnings) {
    EXPECT_EQ(warning.find("bodies_pass"), std::string::npos) << warning;
  }
  EXPECT_EQ(find_passes(*scene.world).size(), 0u);
  constexpr int kSteps = 10;
  for (int k = 0; k < kSteps; ++k) ASSERT_TRUE(scene.world->step()) << scene.world->failure();
  EXPECT_EQ(find_passes(*scene.world).size(), 0u);
}

}  // namespace
}  // namespace pliant::every_scene_test
