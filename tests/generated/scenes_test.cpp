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
constexpr int kThoroughly = 12;  // scenes behind those
constexpr std::uint64_t kSeed = 1;

void expect_no_failure(const SceneChoice& choice, SceneCare care) {
  if (const char* seen = known_defect()) GTEST_SKIP() << "known defect: " << seen;
  const SceneOutcome outcome = try_scene(choice, finger_path(), care);
  if (outcome.fate != SceneFate::kFailed) return;
  const SceneChoice smallest = shrink(choice, [&](const SceneChoice& scene) {
    return try_scene(scene, finger_path(), care).oracle == outcome.oracle;
  });
  ADD_FAILURE() << outcome.oracle << ": " << outcome.message << "\n  of " << choice_text(choice)
                << "\nThe simplest scene with that fault, a file for tests/generated/corpus:\n"
                << choice_text(smallest);
}

const SceneChoice& planned(int number) {
  static const std::vector<SceneChoice> plan = plan_scenes(kScenes + kThoroughly, kSeed);
  return plan[static_cast<std::size_t>(number)];
}

class GeneratedScenes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Planned, GeneratedScenes, testing::Range(0, kScenes));

TEST_P(GeneratedScenes, AreTrue) { expect_no_failure(planned(GetParam()), SceneCare::kUsual); }

// In the mirror, by shorter steps, and against converged ones.
class ThoroughScenes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Planned, ThoroughScenes, testing::Range(kScenes, kScenes + kThoroughly));

TEST_P(ThoroughScenes, AreTrue) { expect_no_failure(planned(GetParam()), SceneCare::kThorough); }

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
  expect_no_failure(choice_of(line, path), SceneCare::kThorough);
}

}  // namespace
}  // namespace pliant::generated_scenes_test
