#include "pliant/scene/batch.h"

#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "pliant/math/error.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

const char* const kDensity = "bodies[0].material.areal_density";

std::vector<std::vector<SceneValue>> densities(const std::vector<std::string>& values) {
  std::vector<std::vector<SceneValue>> rows;
  for (const std::string& value : values) {
    rows.push_back({{kDensity, value, {"table.csv", static_cast<int>(rows.size()) + 2}}});
  }
  return rows;
}

class BatchTest : public ::testing::Test {
 protected:
  ~BatchTest() override { set_threads(1); }
  SceneFiles files_;
  std::string scene_ = write_scene(files_, kFullScene);
};

TEST_F(BatchTest, EachSceneDoesWhatItDoesAlone) {
  const std::vector<std::string> values = {"0.1", "0.2", "0.4"};
  for (int count : {1, 3}) {
    SceneOverrides overrides;
    overrides.threads = count;
    Batch batch(scene_, overrides, densities(values));
    ASSERT_EQ(batch.size(), 3);
    batch.step(7);
    batch.step(13);
    for (int s = 0; s < batch.size(); ++s) {
      SceneOverrides own;
      own.values = densities(values)[static_cast<std::size_t>(s)];
      const LoadedScene alone = load_scene(scene_, own);
      for (int k = 0; k < 20; ++k) ASSERT_TRUE(alone.world->step());
      EXPECT_EQ(batch.world(s).bodies()[0].particles().x, alone.world->bodies()[0].particles().x);
      EXPECT_EQ(batch.world(s).bodies()[0].particles().v, alone.world->bodies()[0].particles().v);
    }
    EXPECT_NE(batch.world(0).bodies()[0].particles().x, batch.world(2).bodies()[0].particles().x);
  }
}

TEST_F(BatchTest, OneThatStopsStopsNoOther) {
  std::vector<std::vector<SceneValue>> rows(3);
  // Beyond its limit from the first step on.
  rows[1] = {{"bodies[0].velocity", "[0, 0, 900]", {"table.csv", 3}},
             {"limits.max_speed", "901", {"table.csv", 3}},
             {"effects.gravity.acceleration", "[0, 0, 1000]", {"table.csv", 3}}};
  Batch batch(scene_, {}, rows);
  batch.step(4);
  EXPECT_TRUE(batch.failure(0).empty());
  EXPECT_NE(batch.failure(1).find("towel"), std::string::npos) << batch.failure(1);
  EXPECT_TRUE(batch.failure(2).empty());
  EXPECT_EQ(batch.world(0).steps(), 4u);
  EXPECT_LT(batch.world(1).steps(), 4u);
  EXPECT_EQ(batch.world(2).steps(), 4u);
}

TEST_F(BatchTest, TheFirstRefusedRowIsTold) {
  SceneOverrides overrides;
  overrides.threads = 2;
  try {
    Batch batch(scene_, overrides, densities({"0.1", "-1", "0.2", "-2"}));
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind("table.csv:3", 0), 0u) << error.what();
  }
}

}  // namespace
}  // namespace pliant
