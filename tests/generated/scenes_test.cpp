// The first scenes of `pliant study stability`, and those in which it has found a fault.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "generated/robot.h"
#include "pliant/study/generated/generated_oracles.h"
#include "support/known_defects.h"

namespace pliant::generated_scenes_test {
namespace {

constexpr int kScenes = 200;
constexpr std::uint64_t kSeed = 1;

void expect_no_failure(const SceneChoice& choice) {
  if (const char* seen = known_defect()) GTEST_SKIP() << "known defect: " << seen;
  const SceneOutcome outcome = try_scene(choice, finger_path());
  if (outcome.fate != SceneFate::kFailed) return;
  const SceneChoice smallest = shrink(choice, [&](const SceneChoice& scene) {
    return try_scene(scene, finger_path()).oracle == outcome.oracle;
  });
  ADD_FAILURE() << outcome.oracle << ": " << outcome.message << "\n  of " << choice_text(choice)
                << "\nThe simplest scene with that fault, a file for tests/generated/corpus:\n"
                << choice_text(smallest);
}

class GeneratedScenes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Planned, GeneratedScenes, testing::Range(0, kScenes));

TEST_P(GeneratedScenes, AreTrue) {
  static const std::vector<SceneChoice> plan = plan_scenes(kScenes, kSeed);
  expect_no_failure(plan[static_cast<std::size_t>(GetParam())]);
}

std::vector<std::string> corpus() {
  std::vector<std::string> names;
  for (const auto& file :
       std::filesystem::directory_iterator(PLIANT_SOURCE_DIR "/tests/generated/corpus")) {
    names.push_back(file.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class GeneratedCorpus : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Found, GeneratedCorpus, testing::ValuesIn(corpus()),
                         [](const auto& info) { return info.param; });

TEST_P(GeneratedCorpus, IsTrue) {
  const std::string path = PLIANT_SOURCE_DIR "/tests/generated/corpus/" + GetParam() + ".scene";
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line) && line[0] == '#') {
  }
  expect_no_failure(choice_of(line, path));
}

}  // namespace
}  // namespace pliant::generated_scenes_test
