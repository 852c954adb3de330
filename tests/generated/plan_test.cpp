// Which scenes are generated, and how one that fails becomes small.
#include <gtest/gtest.h>

#include <set>

#include "pliant/math/error.h"
#include "pliant/study/generated/generated_oracles.h"

namespace pliant::plan_test {
namespace {

int count_of(int factor) {
  return static_cast<int>(scene_factors()[static_cast<std::size_t>(factor)].values.size());
}

int index_of(Factor factor, const std::string& value) {
  const auto& values = scene_factors()[factor].values;
  return static_cast<int>(std::find(values.begin(), values.end(), value) - values.begin());
}

TEST(GeneratedPlan, HoldsEveryTwoValuesThatGoTogether) {
  const std::vector<SceneChoice> plan = plan_scenes(600, 1);
  int missing = 0, pairs = 0;
  for (int one = 0; one < kFactorCount; ++one) {
    for (int other = one + 1; other < kFactorCount; ++other) {
      std::set<std::pair<int, int>> seen;
      for (const SceneChoice& choice : plan) {
        seen.insert(
            {choice[static_cast<std::size_t>(one)], choice[static_cast<std::size_t>(other)]});
      }
      for (int i = 0; i < count_of(one); ++i) {
        for (int j = 0; j < count_of(other); ++j) {
          if (!go_together(static_cast<Factor>(one), i, static_cast<Factor>(other), j)) continue;
          ++pairs;
          missing += seen.count({i, j}) == 0;
        }
      }
    }
  }
  EXPECT_GT(pairs, 2000);
  EXPECT_EQ(missing, 0);
}

TEST(GeneratedPlan, IsTheSameForASeedAndBeginsAlike) {
  EXPECT_EQ(plan_scenes(40, 7), plan_scenes(40, 7));
  EXPECT_NE(plan_scenes(40, 7), plan_scenes(40, 8));
  std::vector<SceneChoice> longer = plan_scenes(50, 7);
  longer.resize(40);
  EXPECT_EQ(longer, plan_scenes(40, 7));
}

TEST(GeneratedPlan, NoSceneHasASolverThatDoesNotMoveItsModel) {
  for (const SceneChoice& choice : plan_scenes(100, 3)) EXPECT_TRUE(is_possible(choice));
  SceneChoice choice{};
  choice[kFactorSolver] = index_of(kFactorSolver, "newmark");
  EXPECT_FALSE(is_possible(choice));
  choice[kFactorModel] = index_of(kFactorModel, "reduced");
  EXPECT_TRUE(is_possible(choice));
}

TEST(GeneratedPlan, ASceneIsALineOfText) {
  for (const SceneChoice& choice : plan_scenes(20, 2)) {
    EXPECT_EQ(choice_of(choice_text(choice), "here"), choice);
  }
  const std::string text = choice_text(SceneChoice{});
  const auto refusal = [](const std::string& bad) -> std::string {
    try {
      choice_of(bad, "here");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal("").find("here: 'model' is missing"), std::string::npos);
  EXPECT_NE(refusal(text + ", colour: red").find("no factor 'colour'"), std::string::npos);
  EXPECT_NE(refusal(text + ", model: cloht").find("'cloth'"), std::string::npos);
  EXPECT_NE(refusal(text + ", cloth").find("' cloth' is no 'name: value'"), std::string::npos);
}

TEST(GeneratedPlan, AFailureIsShrunkToWhatItTakes) {
  SceneChoice choice;
  for (int f = 0; f < kFactorCount; ++f) choice[static_cast<std::size_t>(f)] = count_of(f) - 1;
  choice[kFactorModel] = index_of(kFactorModel, "patch");
  choice[kFactorSolver] = index_of(kFactorSolver, "lbfgs");
  int tried = 0;
  const SceneChoice smallest = shrink(choice, [&](const SceneChoice& scene) {
    ++tried;
    EXPECT_TRUE(is_possible(scene));
    return value_of(scene, kFactorSolver) == "lbfgs" && value_of(scene, kFactorPlace) == "far";
  });
  SceneChoice expected{};
  expected[kFactorSolver] = index_of(kFactorSolver, "lbfgs");
  expected[kFactorPlace] = index_of(kFactorPlace, "far");
  EXPECT_EQ(smallest, expected);
  EXPECT_LT(tried, 3 * kFactorCount);
}

}  // namespace
}  // namespace pliant::plan_test
