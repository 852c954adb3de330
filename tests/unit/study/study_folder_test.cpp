#include "pliant/study/study_folder.h"

#include <gtest/gtest.h>

#include "pliant/study/study_settings.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"
#include "unit/study/study_scenes.h"

namespace pliant {
namespace {

AccuracyRow row_of(const std::string& solver) {
  AccuracyRow row;
  row.solver = solver;
  row.iterations = 1;
  return row;
}

TEST(StudyFolder, KeepsRowsForTheSameSettings) {
  const SceneFiles files;
  const std::string path = files.path("a/b");
  {
    StudyFolder first(path, "steps: 1\n", false);
    first.add(row_of("xpbd"));
    first.add(row_of("jacobi"));
  }
  const StudyFolder second(path, "steps: 1\n", false);
  ASSERT_EQ(second.rows().size(), 2u);
  EXPECT_EQ(second.rows()[1].solver, "jacobi");
  EXPECT_EQ(StudyFolder::settings_in(path), "steps: 1\n");
  EXPECT_EQ(StudyFolder::settings_in(files.path("none")), "");
}

TEST(StudyFolder, RefusesOtherSettingsAndNamesThem) {
  const SceneFiles files;
  StudyFolder(files.path("a"), "scene: x\nsteps: 1\n", false).add(row_of("xpbd"));
  expect_refusal([&] { StudyFolder(files.path("a"), "scene: x\nsteps: 2\n", false); },
                 {"'steps: 1', now 'steps: 2'", "--out", "--overwrite"});
  expect_refusal([&] { StudyFolder(files.path("a"), "scene: x\n", false); },
                 {"'steps: 1', now ''"});
  EXPECT_EQ(StudyFolder(files.path("a"), "scene: x\nsteps: 1\n", false).rows().size(), 1u);
  EXPECT_TRUE(StudyFolder(files.path("a"), "scene: x\nsteps: 2\n", true).rows().empty());
  EXPECT_EQ(StudyFolder::settings_in(files.path("a")), "scene: x\nsteps: 2\n");
}

TEST(StudyFolder, BelongsToOneStudyAtATime) {
  const SceneFiles files;
  {
    const StudyFolder first(files.path("a"), "steps: 1\n", false);
    expect_refusal([&] { StudyFolder(files.path("a"), "steps: 1\n", true); },
                   {"another one is at work there", "--out"});
  }
  StudyFolder(files.path("a"), "steps: 1\n", false);
}

TEST(StudyFolder, RefusesForeignTables) {
  const SceneFiles files;
  files.write("a/accuracy.csv", "x,y\n1,2\n");
  expect_refusal([&] { StudyFolder(files.path("a"), "steps: 1\n", false); },
                 {"accuracy.yaml", "--out", "move it away"});
  files.write("b/accuracy.csv", "x,y\n1,2\n");
  files.write("b/accuracy.yaml", "steps: 1\n");
  expect_refusal([&] { StudyFolder(files.path("b"), "steps: 1\n", false); },
                 {"b/accuracy.csv:1", "no table"});
}

TEST(StudyFolder, RefusesWhatIsNoFolder) {
  const SceneFiles files;
  files.write("file", "text");
  expect_refusal([&] { StudyFolder(files.path("file"), "steps: 1\n", false); }, {"file"});
  expect_refusal([&] { StudyFolder("/proc/x", "steps: 1\n", false); }, {"/proc/x"});
}

TEST(StudyFolder, LivesInMemoryWithoutAFolder) {
  StudyFolder folder;
  folder.add(row_of("xpbd"));
  EXPECT_EQ(folder.rows().size(), 1u);
  EXPECT_EQ(folder.directory(), "");
}

class StudySettings : public ::testing::Test {
 protected:
  std::uint64_t hash_of(const std::string& text) {
    return scene_hash(read_scene(files_.write("scene.yaml", text)));
  }
  SceneFiles files_;
};

TEST_F(StudySettings, HashFollowsWhatTheSceneMeans) {
  const std::uint64_t hash = hash_of(kSmallScene);
  EXPECT_EQ(hash_of(kSmallScene), hash);
  for (const auto& [from, to] : {std::pair("rate: 0.5", "rate: 0.6"),
                                 {"time_step: 0.005", "time_step: 0.004"},
                                 {"upper_right", "lower_right"},
                                 {"shear: 2", "shear: 3"}}) {
    EXPECT_NE(hash_of(replaced(kSmallScene, from, to)), hash) << to;
  }
  EXPECT_EQ(hash_of(replaced(kSmallScene, "name: xpbd, iterations: 20", "name: jacobi")), hash);
  EXPECT_EQ(hash_of(std::string("description: other\n# remark\n") + kSmallScene), hash);
}

TEST_F(StudySettings, HashFollowsTheFilesThatASceneNames) {
  const std::uint64_t hash = scene_hash(read_scene(write_scene(files_, kFullScene)));
  files_.write("motion.yaml", replaced(kLiftMotion, "0.5", "0.6"));
  EXPECT_NE(scene_hash(read_scene(files_.path("scene.yaml"))), hash);
}

TEST_F(StudySettings, OptionsComeBack) {
  const SceneSpec scene = read_scene(files_.write("scene.yaml", kSmallScene));
  AccuracyOptions options = small_study();
  options.time_steps = {0.01, 0.005};
  const AccuracyPlan plan = make_accuracy_plan(scene, options);
  const std::string text = settings_text(plan);
  const auto back = options_from_settings(text, "accuracy.yaml", scene_hash(scene));
  ASSERT_TRUE(back);
  EXPECT_EQ(settings_text(make_accuracy_plan(scene, *back)), text);
  EXPECT_FALSE(options_from_settings(text, "accuracy.yaml", scene_hash(scene) + 1));
}

TEST_F(StudySettings, RefusesOtherTexts) {
  expect_refusal([] { options_from_settings("steps: 1\n", "a.yaml", 0); }, {"a.yaml"});
  expect_refusal([] { options_from_settings("[", "a.yaml", 0); }, {"a.yaml"});
}

}  // namespace
}  // namespace pliant
