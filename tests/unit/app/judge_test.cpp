// `pliant study judge`, as users call it.
#include <gtest/gtest.h>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant::judge_cli_test {
namespace {

TEST(JudgeCli, PrintsTheTableAndWritesIt) {
  const SceneFiles files;
  const std::string folder = files.path("judged");
  const Outcome outcome = run("study judge --judges torsion --out " + folder);

  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part : {"| judge ", "| torsion | torque of a twist", "Saint-Venant 1855",
                           "1 figures, 0 misses", "written: tables in "}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << "\n" << outcome.text;
  }
  EXPECT_FALSE(holds(outcome.text, "picture")) << "it has no curve\n" << outcome.text;
  EXPECT_TRUE(holds(contents(folder + "/judges.csv"), "torsion,"));
}

TEST(JudgeCli, RefusesWhatItDoesNotKnow) {
  const SceneFiles files;
  files.write("other.csv", "a\n1\n");
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"--judges torsoin", "did you mean 'torsion'?"},
           {"--judges torsion,torsion", "--judges"},
           {"--judges torsion --out " + files.path(""),
            "was not written by `pliant study judge`"}}) {
    const Outcome outcome = run("study judge " + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, says)) << outcome.text;
  }
}

}  // namespace
}  // namespace pliant::judge_cli_test
