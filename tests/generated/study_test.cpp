// `pliant study stability`, as users call it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "pliant/study/generated/generated_factors.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant::stability_study_test {
namespace {

std::string simplest() { return "study stability --scene '" + choice_text(SceneChoice{}) + "'"; }

TEST(StabilityStudy, WritesATableAndARowForEachScene) {
  const SceneFiles files;
  const std::string folder = files.path("study");
  const Outcome outcome = run("study stability --scenes 4 --jobs 2 --out " + folder);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "4 scenes: ")) << outcome.text;
  const std::string rows = contents(folder + "/scenes.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 5) << rows;
  EXPECT_TRUE(holds(contents(folder + "/stability.md"), "### cloth"));
}

TEST(StabilityStudy, OneSceneIsPrintedAsAFileThatRuns) {
  const SceneFiles files;
  const Outcome outcome = run(simplest());
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "# stable")) << outcome.text;
  EXPECT_EQ(run("check " + files.write("printed.yaml", outcome.text)).code, 0) << outcome.text;
}

TEST(StabilityStudy, RefusesWhatItCannotDo) {
  const SceneFiles files;
  const std::string out = " --out " + files.path("study");
  for (const auto& [arguments, says] : std::vector<std::pair<std::string, std::string>>{
           {"study stability", "--out or --scene is needed"},
           {"study stability --scenes 0" + out, "--scenes is 0, but must be from 1 to"},
           {"study stability --jobs 0" + out, "--jobs is 0, but must be from 1 to"},
           {"study stability --scene 'model: cloht'", "--scene: unknown model 'cloht'"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, says)) << outcome.text;
  }
}

}  // namespace
}  // namespace pliant::stability_study_test
