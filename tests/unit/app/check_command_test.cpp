#include <gtest/gtest.h>

#include <string>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

TEST(CheckCommand, SaysWhatToWriteWhereADefaultSolverIsInaccurate) {
  const SceneFiles files;
  const std::string fine = R"(time_step: 0.01
gravity: [0, 0, -9.81]
bodies:
  - name: towel
    model: cloth
    geometry: {grid: {size: [1, 1], vertices: [61, 61]}}
    fixed: [{corner: upper_left}]
effects: {contact: {}}
obstacles: [{name: floor, shape: plane, position: [0, 0, -3]}]
)";
  const Outcome outcome = run("check " + files.write("fine.yaml", fine));
  const std::size_t begin = outcome.text.find("towel: inaccurate: about ");
  ASSERT_NE(begin, std::string::npos) << outcome.text;
  const std::string to_write = "solver: {name: lbfgs}\n";
  EXPECT_NE(outcome.text.find("'xpbd' is the default, to try another write: " + to_write, begin),
            std::string::npos)
      << outcome.text;
  const Outcome cured = run("check " + files.write("cured.yaml", fine + to_write));
  EXPECT_EQ(cured.text, files.path("cured.yaml") + ": OK\n");
  // Who names a solver has chosen.
  const Outcome named = run(
      "check " + files.write("named.yaml",
                             fine + "solver: {name: xpbd, error: 0.03, most_iterations: 200}\n"));
  EXPECT_NE(named.text.find("towel: inaccurate: about "), std::string::npos) << named.text;
  EXPECT_EQ(named.text.find("is the default"), std::string::npos) << named.text;
}

}  // namespace
}  // namespace pliant
