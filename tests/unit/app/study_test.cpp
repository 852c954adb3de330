#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <thread>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"
#include "unit/study/study_scenes.h"

namespace pliant {
namespace {

class StudyCliTest : public ::testing::Test {
 protected:
  StudyCliTest() : scene_(files_.write("scene.yaml", kSmallScene)) {}
  std::string accuracy(const std::string& arguments) const {
    return "study accuracy " + scene_ + " --steps 6 --samples 2 --repeats 2 " + arguments;
  }
  std::string advise(const std::string& arguments) const {
    return "study advise " + scene_ + " --steps 6 --samples 2 --repeats 2 " + arguments;
  }
  SceneFiles files_;
  std::string scene_;
};

/// Only the columns before those of times.
std::string without_times(const std::string& csv) {
  std::istringstream lines(csv);
  std::string result;
  std::string line;
  std::getline(lines, line);
  const std::string head = line.substr(0, line.find(",step_s"));
  const auto columns = std::count(head.begin(), head.end(), ',') + 1;
  for (; std::getline(lines, line);) {
    std::size_t end = 0;
    for (auto k = columns; k > 0; --k) end = line.find(',', end + 1);
    result += line.substr(0, end) + "\n";
  }
  return result;
}

TEST_F(StudyCliTest, RefusesBadArgumentsWithCode2) {
  for (const std::string& arguments : {std::string("study"),
                                       std::string("study fly"),
                                       std::string("study accuracy /none.yaml"),
                                       accuracy("--solvers ''"),
                                       accuracy("--solvers xpbd,xpbd"),
                                       accuracy("--iterations ''"),
                                       accuracy("--iterations 1,-2"),
                                       accuracy("--dt 0"),
                                       accuracy("--time-integrations bdf2"),
                                       accuracy("--time-integrations bdf3 --dt 0.005"),
                                       accuracy("--dt 0.007"),
                                       accuracy("--duration 1"),
                                       accuracy("--references verlet"),
                                       accuracy("--time-step 0"),
                                       accuracy("--threads 0"),
                                       accuracy("--overwrite"),
                                       accuracy("--out /proc/x"),
                                       accuracy("--what"),
                                       "study accuracy " + scene_ + " --samples 0",
                                       "study accuracy " + scene_ + " --steps nan",
                                       advise(""),
                                       advise("--error nan"),
                                       advise("--error 0.1 --budget 16"),
                                       advise("--error 0.1 --dt 0.007"),
                                       advise("--error 0.1 --time-integrations bdf2")}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.text;
    EXPECT_FALSE(outcome.text.empty());
  }
  EXPECT_TRUE(holds(run(accuracy("--solvers xpdb")).text, "did you mean 'xpbd'?"));
}

TEST_F(StudyCliTest, LiftsClothAndCountsSteps) {
  const std::string folder = files_.path("cloth");
  const Outcome outcome = run("study cloth --no-plot --share 0.02 --out " + folder);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  const std::string lift = contents(folder + "/lift.csv"), speed = contents(folder + "/speed.csv");
  for (const char* part : {"points,air_cm3,height_mm", "\nsatin,1,0,", "\nsatin,1,400,",
                           "\nsatin,2,0,", "\nsatin,2,400,"}) {
    EXPECT_TRUE(holds(lift, part)) << part;
  }
  // The four lifts of the thesis and five with something changed, ten rows each after the first.
  const std::string thesis = contents(folder + "/thesis.csv");
  EXPECT_EQ(std::count(thesis.begin(), thesis.end(), '\n'), 1 + 9 * 11) << thesis;
  for (const char* part : {"\nthesis,1,0,50.00", "\nthesis,2,400,50.00", "\nshear 50 N/m,1,400,"}) {
    EXPECT_TRUE(holds(thesis, part)) << part;
  }
  EXPECT_FALSE(holds(thesis, "nan"));
  EXPECT_TRUE(holds(contents(folder + "/thesis_states.csv"), "\nthesis,1,400,50.0,6,6,"));
  EXPECT_EQ(std::count(speed.begin(), speed.end(), '\n'), 13) << speed;
  EXPECT_EQ(std::count(speed.begin(), speed.end(), '"'), 24) << speed;
  EXPECT_FALSE(holds(lift, "nan"));
  EXPECT_EQ(run("study cloth --share 2 --out " + folder).code, 2);
  const Outcome unknown = run("study cloth --experiment lyft --out " + folder);
  EXPECT_EQ(unknown.code, 2);
  EXPECT_TRUE(holds(unknown.text, "did you mean 'lift'?")) << unknown.text;
}

TEST_F(StudyCliTest, MeasuresPrintsAndDraws) {
  const Outcome outcome = run(
      accuracy("--solvers jacobi,xpbd --iterations 1,8,400 --references newton,lbfgs --dt 0.005 "
               "--out " +
               files_.path("out")));
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part : {"Step error", "Run error", "The references newton and lbfgs differ by",
                           "Cheapest for an error of at most", "ms a step", "newton at 0.00125 s",
                           "written: ", "accuracy.png"}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << "\n" << outcome.text;
  }
  const std::string csv = contents(files_.path("out/accuracy.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 13);
  for (const char* name : {"out/accuracy.png", "out/accuracy.svg", "out/accuracy.yaml"}) {
    EXPECT_GT(std::filesystem::file_size(files_.path(name)), 100u) << name;
  }
  EXPECT_EQ(contents(files_.path("out/accuracy.png")).substr(1, 3), "PNG");
}

TEST_F(StudyCliTest, IsTheSameTwiceAndOnTwoThreads) {
  const std::string options = "--solvers jacobi,xpbd --iterations 1,4 --no-plot --out ";
  EXPECT_EQ(run(accuracy(options + files_.path("a"))).code, 0);
  EXPECT_EQ(run(accuracy(options + files_.path("b") + " --threads 2")).code, 0);
  const std::string table = without_times(contents(files_.path("a/accuracy.csv")));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
  EXPECT_EQ(table, without_times(contents(files_.path("b/accuracy.csv"))));
  EXPECT_EQ(contents(files_.path("a/accuracy.yaml")), contents(files_.path("b/accuracy.yaml")));
}

TEST_F(StudyCliTest, AFolderBelongsToOneStudy) {
  const std::string out = " --no-plot --out " + files_.path("a");
  EXPECT_EQ(run(accuracy("--solvers xpbd --iterations 1" + out)).code, 0);
  const std::string table = contents(files_.path("a/accuracy.csv"));
  EXPECT_EQ(run(accuracy("--solvers xpbd --iterations 1" + out)).code, 0);
  EXPECT_EQ(contents(files_.path("a/accuracy.csv")), table);  // nothing was measured again
  const Outcome other = run(accuracy("--solvers xpbd --iterations 2" + out));
  EXPECT_EQ(other.code, 2);
  EXPECT_TRUE(holds(other.text, "iterations: \"1\"', now 'iterations: \"2\"")) << other.text;
  files_.write("scene.yaml", replaced(kSmallScene, "rate: 0.5", "rate: 0.6"));
  EXPECT_EQ(run(accuracy("--solvers xpbd --iterations 1" + out)).code, 2);
  EXPECT_EQ(run(accuracy("--solvers xpbd --iterations 1 --overwrite" + out)).code, 0);
}

TEST_F(StudyCliTest, MeasuresWholeRunsByEachTimeIntegration) {
  const std::string out = files_.path("out");
  const Outcome outcome =
      run(accuracy("--solvers newton --iterations 8 --dt 0.005 --no-plot --time-integrations "
                   "implicit_euler,bdf2,midpoint --out " +
                   out));
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const std::string csv = contents(out + "/accuracy.csv");
  for (const char* row : {"run,newton,implicit_euler,8", "run,newton,bdf2,8",
                          "run,newton,midpoint,8", "step,newton,implicit_euler,8"}) {
    EXPECT_TRUE(holds(csv, row)) << csv;
  }
  EXPECT_TRUE(holds(outcome.text, "time_integration")) << outcome.text;
  // Advice from the same study: the cheapest that keeps the error, in words that a scene takes.
  const Outcome advice = run_command(kProgram + " study advise " + scene_ + " --error 0.02 --out " +
                                     out + " 2>/dev/null");
  ASSERT_EQ(advice.code, 0) << advice.text;
  EXPECT_TRUE(holds(advice.text, "# error of the run ")) << advice.text;
  EXPECT_TRUE(holds(advice.text, "\ntime_step: 0.005\ntime_integration: ")) << advice.text;
  EXPECT_TRUE(holds(advice.text, "name: newton\n  iterations: 8")) << advice.text;
  const std::string included = files_.write("advised.yaml", "include: scene.yaml\n" + advice.text);
  EXPECT_EQ(run("check " + included).code, 0) << run("check " + included).text;
  EXPECT_TRUE(holds(contents(out + "/accuracy.yaml"),
                    "time_integrations: \"implicit_euler,bdf2,midpoint\""));
}

TEST_F(StudyCliTest, CtrlCKeepsTheRowsAndTheStudyGoesOn) {
  const std::string out = files_.path("out");
  const std::string options = "study accuracy " + scene_ +
                              " --steps 6 --samples 2 --repeats 300 --no-plot "
                              "--solvers jacobi --iterations 1,2,4,8,40000 --out " +
                              out;
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", ("exec " + kProgram + " " + options + " 2>/dev/null").c_str(),
          nullptr);
    _exit(99);
  }
  const std::string path = out + "/accuracy.csv";
  std::error_code ignored;
  for (int i = 0; i < 3000 && !std::filesystem::exists(path, ignored); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string csv = contents(path);
  EXPECT_EQ(csv.back(), '\n');
  const auto rows = std::count(csv.begin(), csv.end(), '\n') - 1;
  EXPECT_GE(rows, 1);
  EXPECT_LT(rows, 5);
  for (const auto& entry : std::filesystem::directory_iterator(out)) {
    EXPECT_NE(entry.path().extension(), ".tmp");
  }
}

TEST_F(StudyCliTest, AReferenceThatBlowsUpEndsWith3) {
  files_.write("scene.yaml", std::string(kSmallScene) + "limits: {max_speed: 0.01}\n");
  const Outcome outcome = run(accuracy("--solvers xpbd --iterations 1"));
  EXPECT_EQ(outcome.code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "error: the reference: body 'cloth'")) << outcome.text;
}

TEST_F(StudyCliTest, AdviceIsASceneSnippetThatCheckAccepts) {
  const std::string command = kProgram + " " +
                              advise(
                                  "--error 0.5 --budget 10s --solvers jacobi,xpbd "
                                  "--iterations 1,16,256") +
                              " 2>/dev/null";
  const Outcome outcome = run_command(command);
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "# error ")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "solver:\n  name: ")) << outcome.text;
  const std::string pasted = files_.write(
      "pasted.yaml", replaced(kSmallScene, "solver: {name: xpbd, iterations: 20}\n", outcome.text));
  EXPECT_EQ(run("check " + pasted).code, 0) << run("check " + pasted).text;
  const std::string included =
      files_.write("included.yaml", "include: scene.yaml\n" + outcome.text);
  EXPECT_EQ(run("check " + included).code, 0) << run("check " + included).text;
  EXPECT_EQ(run("run " + pasted + " --steps 3").code, 0);
}

TEST_F(StudyCliTest, AdviceSaysWhatThereIsWhenNothingFits) {
  const std::string solvers = "--solvers jacobi --references newton,lbfgs --iterations 1,512 ";
  const Outcome slow = run(advise(solvers + "--error 0.1 --budget 1us"));
  EXPECT_EQ(slow.code, 4) << slow.text;
  EXPECT_TRUE(holds(slow.text, "# No solver keeps the budget")) << slow.text;
  EXPECT_TRUE(holds(slow.text, "# What the error costs")) << slow.text;
  const Outcome exact = run(advise(solvers + "--error 1e-12 --budget 1s"));
  EXPECT_EQ(exact.code, 4) << exact.text;
  EXPECT_TRUE(holds(exact.text, "# The best within the budget")) << exact.text;
  EXPECT_TRUE(holds(exact.text, "# The references disagree by")) << exact.text;
  // Of whole runs, by each time integration of the model.
  const Outcome runs = run(advise(solvers + "--error 1e-12 --dt 0.005"));
  EXPECT_EQ(runs.code, 4) << runs.text;
  EXPECT_TRUE(holds(runs.text, "#   time_integration: ")) << runs.text;
}

TEST_F(StudyCliTest, AdviceTakesTheStudyOfThisSceneThatIsThere) {
  const std::string out = " --no-plot --out " + files_.path("a");
  EXPECT_EQ(run(accuracy("--solvers jacobi --iterations 1,64" + out)).code, 0);
  const std::string table = contents(files_.path("a/accuracy.csv"));
  const std::string again = "study advise " + scene_ + " --error 0.1 --out " + files_.path("a");
  const Outcome outcome = run(again);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "name: jacobi\n  iterations: 64")) << outcome.text;
  EXPECT_EQ(contents(files_.path("a/accuracy.csv")), table);
  files_.write("scene.yaml", replaced(kSmallScene, "rate: 0.5", "rate: 0.6"));
  EXPECT_EQ(run(again).code, 2);
}

TEST_F(StudyCliTest, ViscoelasticWritesEveryTable) {
  const Outcome outcome =
      run("study viscoelastic --share 0.004 --no-plot --out " + files_.path("tables"));
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const std::map<std::string, std::vector<std::string>> expected = {
      {"solvers", {"line_search_jacobi", "held", "free", "angular_momentum_lost"}},
      {"shape_matching", {"weighted_jacobi", "hybrid", "cube", "angular_momentum_lost"}},
      {"clusters", {"iterations_in_33_ms", "chebyshev", "jacobi"}},
      {"figure", {"none", "qlerp", "exponential", "apart_from_qlerp"}},
      {"centres", {"clusters,x_m,y_m,z_m"}},
      {"states", {"rigid", "elastic", "viscoelastic", "liquid"}},
      {"thin", {"shape_matching", "oriented_particles", "gauss_seidel"}},
      {"plates", {"shape_matching", "oriented_particles", "gauss_seidel"}},
      {"rendering", {"nearest", "qlerp", "exponential"}},
      {"interpolation", {"qlerp_ns", "exponential_ns"}},
      {"speed", {"rigid", "elastic", "viscoelastic", "liquid", "phases"}}};
  for (const auto& [table, words] : expected) {
    const std::string text = contents(files_.path("tables/" + table + ".csv"));
    for (const std::string& word : words) {
      EXPECT_NE(text.find(word), std::string::npos) << word << " is not in " << table << ".csv";
    }
    EXPECT_EQ(text.find("nan"), std::string::npos) << table;
    EXPECT_EQ(text.find("inf"), std::string::npos) << table;
  }
}

}  // namespace
}  // namespace pliant
