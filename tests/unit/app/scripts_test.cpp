// Scripts refuse what they cannot use, and say what they did by their exit codes.
#include <gtest/gtest.h>

#include <filesystem>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

TEST(PlotAccuracy, RefusesOtherTables) {
  const std::string script = std::string(PLIANT_SOURCE_DIR) + "/scripts/plot_accuracy ";
  const SceneFiles files;
  EXPECT_EQ(run_command(script + "--help").code, 0);
  EXPECT_EQ(run_command(script).code, 2);
  EXPECT_EQ(run_command(script + files.path("none")).code, 2);
  files.write("a/accuracy.csv", "x,y\n1,2\n");
  const Outcome outcome = run_command(script + files.path("a"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(holds(outcome.text, "this is no table of `pliant study accuracy`")) << outcome.text;
  const Outcome several = run_command(script + files.path("a") + " " + files.path("a"));
  EXPECT_EQ(several.code, 2);
  EXPECT_TRUE(holds(several.text, "several folders need --out")) << several.text;
}

TEST(RenderCloth, RefusesOtherTables) {
  const std::string script = std::string(PLIANT_SOURCE_DIR) + "/scripts/render_cloth ";
  const SceneFiles files;
  EXPECT_EQ(run_command(script + "--help").code, 0);
  EXPECT_EQ(run_command(script).code, 2);
  const Outcome missing = run_command(script + files.path("none"));
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(holds(missing.text, "pliant study cloth --experiment lift --out")) << missing.text;
  for (const char* name : {"1_0", "1_400", "2_0", "2_400"}) {
    files.write(std::string("a/") + name + ".csv", "x,y\n1,2\n");
  }
  const Outcome outcome = run_command(script + files.path("a"));
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(holds(outcome.text, "this is no table of `pliant study cloth`")) << outcome.text;
}

/// A stand-in for compute-sanitizer and a program of tests whose names say what happens to them.
class Sanitize : public testing::Test {
 protected:
  Sanitize() {
    program("compute-sanitizer",
            "[ \"$1\" = --version ] && exit 0\n"
            "echo '========= COMPUTE-SANITIZER'\n"
            "case \"$*\" in *Races*) echo '========= Error: Race reported'; exit 77;; "
            "*Long*) exec sleep 60;; esac\n"
            "while [ \"${1#--}\" != \"$1\" ]; do shift 2; done\n"
            "\"$@\" || exit $?\n"
            "echo '========= RACECHECK SUMMARY: 0 hazards displayed'\n");
    program("tests",
            "case \"$1\" in --gtest_list_tests)\n"
            "case \"$2\" in *Nothing*) exit 0;; esac\n"
            "printf 'Kernels.\\n  Add  # of many\\n'\n"
            "case \"$2\" in *More*) printf '  Races\\n  Fail\\n  Long\\n  Skip\\n';;\n"
            "*Brief*) printf '  Brief\\n';; esac;;\n"
            "*Fail*) exit 1;; *Brief*) [ -n \"$PLIANT_BRIEF\" ];;\n"
            "*Skip*) echo '[  SKIPPED ] 1 test';; *) echo '[  PASSED  ] 1 test';;\n"
            "esac\n");
  }
  void program(const std::string& name, const std::string& text) const {
    files_.write(name, "#!/bin/sh\n" + text);
    fs::permissions(files_.path(name), fs::perms::owner_all);
  }
  Outcome run(const std::string& arguments) const {
    return run_command("PATH=" + files_.path("") + ":$PATH " + PLIANT_SOURCE_DIR +
                       "/scripts/sanitize --program " + files_.path("tests") + " --log " +
                       files_.path("log") + " " + arguments);
  }
  const SceneFiles files_;
};

TEST_F(Sanitize, CountsWhatIsCleanReportedCutAndSkipped) {
  const Outcome all = run("--tests More --tool racecheck --seconds 1 --gpus 2");
  EXPECT_EQ(all.code, 1) << all.text;
  EXPECT_TRUE(holds(all.text, "racecheck Kernels.Races: bad")) << all.text;
  EXPECT_TRUE(holds(all.text, "1 clean, 1 skipped, 1 cut, 2 bad")) << all.text;
  EXPECT_TRUE(holds(contents(files_.path("log")), "Error: Race reported"));
}

TEST_F(Sanitize, SaysByItsExitCodeWhetherAllIsClean) {
  const Outcome clean = run("--tests Add --beside 1");
  EXPECT_EQ(clean.code, 0) << clean.text;
  EXPECT_TRUE(holds(clean.text, "2/2 racecheck Kernels.Add: clean")) << clean.text;
  EXPECT_EQ(run("--tests Brief").code, 0) << "tests are to be brief";
  EXPECT_EQ(run("--tests Brief --full").code, 1);
  EXPECT_EQ(run("--tests Nothing").code, 2);
  EXPECT_EQ(run("--tool lint").code, 2);
  EXPECT_EQ(run("--gpus 0").code, 2);
  const Outcome none = run("--beside 0");
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(holds(none.text, "--beside: 0 is not at least 1")) << none.text;
  EXPECT_EQ(run("--help").code, 0);
  const Outcome missing = run("--program " + files_.path("none"));
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(holds(missing.text, "build cuda_tests")) << missing.text;
}

}  // namespace
}  // namespace pliant
