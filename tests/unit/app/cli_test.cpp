#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <sstream>
#include <thread>

#include "pliant/effects/registry.h"
#include "pliant/solvers/registry.h"
#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

/// All files of a folder but batch.yaml, one after the other.
std::map<std::string, std::string> files_in(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name != "batch.yaml") files[name] = contents(entry.path().string());
  }
  return files;
}

class CliTest : public ::testing::Test {
 protected:
  CliTest() : scene_(write_scene(files_, kFullScene)) {}
  SceneFiles files_;
  std::string scene_;
};

TEST_F(CliTest, VersionIsThatOfThePackage) {
  const std::string xml = contents(std::string(PLIANT_SOURCE_DIR) + "/package.xml");
  const auto begin = xml.find("<version>") + 9;
  const std::string version = xml.substr(begin, xml.find("</version>") - begin);
  for (const char* arguments :
       {"--version", "run --version", "check --version", "list --version", "describe --version",
        "collider --version", "fit --version", "study --version", "study advise --version"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.text, "pliant " + version + "\n");
  }
}

TEST_F(CliTest, HelpNamesTheExitCodes) {
  for (const char* arguments :
       {"--help", "run --help", "check -h", "list --help", "describe --help", "study --help",
        "study accuracy --help", "study advise -h", "collider --help", "fit --help"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 0);
    for (const char* part : {"0 done", "2 bad input", "130 interrupted"}) {
      EXPECT_TRUE(holds(outcome.text, part)) << outcome.text;
    }
  }
}

TEST_F(CliTest, RefusesBadArgumentsWithCode2) {
  for (const std::string& arguments :
       {std::string(),
        std::string("fly"),
        std::string("check"),
        std::string("check /none.yaml"),
        "run " + scene_,
        "run " + scene_ + " --steps 1 --duration 1",
        "run " + scene_ + " --steps 0",
        "run " + scene_ + " --steps -1",
        "run " + scene_ + " --steps 1.5",
        "run " + scene_ + " --steps nan",
        "run " + scene_ + " --duration inf",
        "run " + scene_ + " --steps x",
        "run " + scene_ + " --steps 1 --solver nope",
        "run " + scene_ + " --steps 1 --set iterations",
        "run " + scene_ + " --steps 1 --set a=1",
        "run " + scene_ + " --steps 1 --threads 0",
        "run " + scene_ + " --steps 1 --time-step 0",
        "run " + scene_ + " --steps 1 --out /proc/x",
        "run " + scene_ + " --steps 1 --what",
        "run " + scene_ + " --steps 1 --out " + files_.path("o") + " --every -1",
        std::string("list everything")}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.text;
    EXPECT_FALSE(outcome.text.empty());
  }
}

TEST_F(CliTest, CheckSaysOkOrWhatIsWrong) {
  EXPECT_EQ(run("check " + scene_).code, 0);
  EXPECT_TRUE(holds(run("check " + scene_).text, "OK"));
  files_.write("scene.yaml", replaced(kFullScene, "thickness", "thicknes"));
  const Outcome outcome = run("check " + scene_);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(holds(outcome.text, scene_ + ":24: unknown key 'thicknes'")) << outcome.text;
}

TEST_F(CliTest, CheckTellsWhatTheFirstStepsWarnOf) {
  const std::string hanging =
      std::string(PLIANT_SOURCE_DIR) + "/config/scenes/small_hanging_cloth.yaml";
  const Outcome quiet = run("check " + hanging);
  EXPECT_EQ(quiet.code, 0) << quiet.text;
  EXPECT_FALSE(holds(quiet.text, "warning")) << quiet.text;

  // Far above the step that an explicit solver can take, but in substeps.
  EXPECT_FALSE(holds(run("check " + hanging + " --solver verlet").text, "warning"));
  const std::string whole_steps = " --solver verlet --set max_substeps=1";
  const Outcome wild = run("check " + hanging + whole_steps);
  EXPECT_EQ(wild.code, 3) << wild.text;
  EXPECT_TRUE(holds(wild.text, "in the first 20 steps: cloth: unstable_step")) << wild.text;
  EXPECT_TRUE(holds(wild.text, "error: " + hanging + ": body 'cloth'")) << wild.text;

  const Outcome two = run("check " + hanging + whole_steps + " --steps 2");
  EXPECT_EQ(two.code, 0) << two.text;
  EXPECT_TRUE(holds(two.text, "OK, with 1 warning")) << two.text;
  const Outcome none = run("check " + hanging + whole_steps + " --steps 0");
  EXPECT_FALSE(holds(none.text, "warning")) << none.text;
  EXPECT_EQ(run("check " + hanging + " --steps -1").code, 2);
}

TEST_F(CliTest, RunRecordsAndSummarises) {
  const Outcome outcome = run("run " + scene_ +
                              " --duration 0.1 --solver jacobi --set "
                              "iterations=3 --set tolerance=0 --out " +
                              files_.path("out"));
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part : {"test: 20 steps", "times real time", "contact", "kinetic", "written"}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << "\n" << outcome.text;
  }
  const std::string csv = contents(files_.path("out/steps.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 21);
  EXPECT_TRUE(holds(csv, ",jacobi,implicit_euler,,3,"));
  EXPECT_TRUE(std::filesystem::exists(files_.path("out/frames/towel_000020.ply")));
  EXPECT_EQ(run("run " + scene_ + " --steps 1 --out " + files_.path("out")).code, 2);
  EXPECT_EQ(
      run("run " + scene_ + " --steps 1 --quiet --overwrite --out " + files_.path("out")).text, "");
}

TEST_F(CliTest, WhatCannotBeWrittenIsAnError) {
  // As on a full disk.
  const std::vector<std::string> commands = {"list solvers", "describe " + scene_,
                                             "check " + scene_, "run " + scene_ + " --steps 1"};
  for (const std::string& arguments : commands) {
    const Outcome outcome =
        run_command("( " + kProgram + " " + arguments + " 3>&1 1>/dev/full 2>&3 )");
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, "error: cannot write to standard output")) << outcome.text;
  }
  // A file that may have 1 kB: rows are lost as they are written, or only when all is done.
  for (const char* steps : {"20", "400"}) {
    const Outcome rows = run_command("( trap '' XFSZ; ulimit -f 2; " + kProgram + " run " + scene_ +
                                     " --every 0 --overwrite --steps " + steps + " --out " +
                                     files_.path("small") + " )");
    EXPECT_EQ(rows.code, 2) << steps << rows.text;
    EXPECT_TRUE(holds(rows.text, "steps.csv")) << rows.text;
    EXPECT_TRUE(holds(rows.text, "File too large")) << rows.text;
    EXPECT_FALSE(std::filesystem::exists(files_.path("small/steps.csv")));
  }
  const Outcome frame = run_command("( trap '' XFSZ; ulimit -f 0; " + kProgram + " run " + scene_ +
                                    " --steps 1 --out " + files_.path("frames") + " )");
  EXPECT_EQ(frame.code, 2) << frame.text;
  EXPECT_TRUE(holds(frame.text, "towel_000000.ply")) << frame.text;
}

TEST_F(CliTest, AFullDiskLeavesNoHalfFile) {
  // Files may have so many blocks of 1 kB: what is longer is refused, as on a full disk.
  const auto full = [&](const std::string& arguments, const char* blocks) {
    return run_command("( ulimit -f " + std::string(blocks) + "; " + kProgram + " " + arguments +
                       " )");
  };
  const std::string out = files_.path("full");
  const std::string batch = "run " + scene_ + " --steps 20 --batch 40 --out " + out;
  const Outcome rows = full(batch, "2");
  EXPECT_EQ(rows.code, 2) << rows.text;
  EXPECT_TRUE(holds(rows.text, "File too large")) << rows.text;
  // Room is made, and the batch goes on to the same bytes as one that had it from the start.
  const Outcome resumed = run(batch + " --resume");
  EXPECT_EQ(resumed.code, 0) << resumed.text;
  ASSERT_EQ(run("run " + scene_ + " --steps 20 --batch 40 --out " + files_.path("free")).code, 0);
  EXPECT_EQ(files_in(out), files_in(files_.path("free")));
  for (const std::string& arguments :
       {"reduce tower --modes 3 --rank 5 --out " + files_.path("body.prm"),
        "study cloth --no-plot --share 0.02 --experiment lift --out " + files_.path("tables"),
        "study accuracy " + scene_ + " --steps 10 --solvers xpbd --iterations 1 --out " +
            files_.path("accuracy")}) {
    const Outcome outcome = full(arguments, "0");
    EXPECT_EQ(outcome.code, 2) << arguments << outcome.text;
    EXPECT_TRUE(holds(outcome.text, "File too large")) << outcome.text;
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(files_.path("."))) {
    const std::string path = entry.path().string();
    EXPECT_FALSE(holds(path, ".tmp")) << path;
    EXPECT_FALSE(entry.is_regular_file() && entry.file_size() == 0) << path;
  }
}

TEST_F(CliTest, ResultsReplaceNothingThatNoRunWrote) {
  struct Row {
    std::string arguments, file;
  };
  const std::vector<Row> cases = {
      {"run " + scene_ + " --steps 1", "steps.csv"},
      {"run " + scene_ + " --steps 1", "frames/towel_000000.ply"},
      {"run " + scene_ + " --steps 1 --batch 2", "scenes.csv"},
      {"run " + scene_ + " --steps 1 --batch 2", "positions_towel.npy"},
      {"study accuracy " + scene_ + " --steps 10 --solvers xpbd --iterations 1", "accuracy.csv"},
      {"study cloth --no-plot --share 0.02 --experiment lift", "lift.csv"},
      {"study viscoelastic --no-plot --share 0.004 --experiment thin", "thin.png"},
      {"study reduced --no-plot --experiment floor", "floor.csv"},
      {"study reduced --no-plot --experiment floor", "parts/notes"}};
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const std::string folder = "mine_" + std::to_string(k), name = folder + "/" + cases[k].file;
    files_.write(name, "my own work\n");
    const bool has_flag = !holds(cases[k].arguments, "--no-plot");
    for (const std::string flag : {"", " --overwrite"}) {
      if (!has_flag && !flag.empty()) continue;
      const Outcome outcome = run(cases[k].arguments + " --out " + files_.path(folder) + flag);
      EXPECT_EQ(outcome.code, 2) << cases[k].arguments << flag << outcome.text;
      // A path of a folder's own names what lies in it.
      const std::string named = cases[k].file.substr(0, cases[k].file.find("/notes"));
      EXPECT_TRUE(holds(outcome.text, folder + "/" + named)) << outcome.text;
      EXPECT_EQ(contents(files_.path(name)), "my own work\n") << cases[k].arguments << flag;
    }
  }
}

TEST_F(CliTest, ASceneQuotesNoFileOfItsReader) {
  const SceneFiles other;
  const std::string secret = other.write("passwd", "root:x:0:0:secret words\n: [\n");
  const std::string urdf = other.write("r.urdf", kLiftUrdf);
  std::filesystem::create_symlink(secret, files_.path("link.yaml"));
  const std::string grid = "grid: {size: [1, 2], vertices: [4, 5]}";
  const std::vector<std::string> scenes = {
      "include: " + secret + "\n" + kFullScene, std::string("include: link.yaml\n") + kFullScene,
      replaced(kFullScene, grid, "mesh: " + secret),
      replaced(kFullScene, "urdf: robot.urdf", "urdf: " + secret),
      replaced(kFullScene, "keyframes: motion.yaml", "keyframes: " + secret)};
  for (const std::string& text : scenes) {
    files_.write("scene.yaml", text);
    const Outcome outcome = run("check " + scene_);
    EXPECT_EQ(outcome.code, 2) << text;
    EXPECT_TRUE(holds(outcome.text, "lies outside of what a scene may read")) << outcome.text;
    EXPECT_FALSE(holds(outcome.text, "secret")) << outcome.text;
  }
  // What is asked for is read.
  files_.write("scene.yaml", replaced(kFullScene, "urdf: robot.urdf", "urdf: " + urdf));
  EXPECT_EQ(run("check " + scene_).code, 2);
  EXPECT_EQ(run("check --allow-outside " + scene_).code, 0);
  const Outcome named =
      run_command("PLIANT_FILE_ROOTS=" + other.path("") + " " + kProgram + " check " + scene_);
  EXPECT_EQ(named.code, 0) << named.text;
}

TEST_F(CliTest, RunStopsWith3WhenNotFinite) {
  files_.write("scene.yaml", replaced(kFullScene, "max_speed: 1000", "max_speed: 0.2"));
  const Outcome outcome = run("run " + scene_ + " --steps 100 --out " + files_.path("out"));
  EXPECT_EQ(outcome.code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "towel"));
  EXPECT_TRUE(std::filesystem::exists(files_.path("out/steps.csv")));
}

TEST_F(CliTest, CtrlCWritesWhatIsThereAndExits130) {
  const std::string out = files_.path("out");
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    take_signals();
    execl(kProgram.c_str(), "pliant", "run", scene_.c_str(), "--steps", "1000000000", "--quiet",
          "--every", "0", "--out", out.c_str(), nullptr);
    _exit(99);
  }
  // Interrupted only once it steps: before, there is nothing to write.
  const std::string part = out + "/steps.csv.part";
  std::error_code ignored;
  for (int i = 0; i < 1000 && std::filesystem::file_size(part, ignored) + 1 < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const std::string csv = contents(out + "/steps.csv");
  EXPECT_EQ(csv.substr(0, 10), "step,time,");
  EXPECT_EQ(csv.back(), '\n');
}

TEST_F(CliTest, ListsEverythingInTheRegistries) {
  const Outcome all = run("list");
  EXPECT_EQ(all.code, 0);
  for (const std::string& solver : solver_registry().names()) {
    EXPECT_TRUE(holds(all.text, solver)) << solver;
  }
  for (const std::string& effect : effect_registry().names()) {
    EXPECT_TRUE(holds(all.text, effect)) << effect;
  }
  for (const char* part : {"[m/s^2]", "cloth", "bending"}) {
    EXPECT_TRUE(holds(all.text, part)) << part;
  }
  EXPECT_FALSE(holds(run("list solvers").text, "gravity"));
  EXPECT_TRUE(holds(run("list effects --markdown").text, "| `thickness` |"));
  EXPECT_TRUE(holds(run("list elements --markdown").text, "| `stretch` |"));
  EXPECT_TRUE(holds(run("list integrators --markdown").text, "### `stoermer_verlet`"));
}

TEST_F(CliTest, DescribesAScene) {
  const Outcome outcome = run("describe " + scene_);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part : {"20 vertices (1 fixed)", "elements stretch", "obstacle ground: plane",
                           "on link hand", "robot lift: 2 links, 1 joints", "solver xpbd",
                           "effect contact", "friction", "times real time", "MB"}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << "\n" << outcome.text;
  }
}

TEST_F(CliTest, TellsOfPairsOfBodies) {
  const std::string box =
      "model: rigid, geometry: {box: {size: [0.1, 0.1, 0.1]}}, position: [0, 0, ";
  const std::string scene = files_.write(
      "pairs.yaml", "time_step: 0.005\nbodies:\n  - {name: a, " + box + "0]}\n  - {name: b, " +
                        box + "0.2]}\n  - {name: c, " + box +
                        "0.4]}\neffects:\n  body_contact:\n    pairs: [{bodies: [a, b], friction: "
                        "0.2, thickness: 0.001}]\n    except: [[b, c]]\n    only_pairs: true\n");
  const Outcome outcome = run("describe " + scene);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  for (const char* part :
       {"pair a, b: friction=0.2 thickness=0.001", "pair b, c: left out", "no other pairs"}) {
    EXPECT_TRUE(holds(outcome.text, part)) << part << "\n" << outcome.text;
  }
  for (const char* list : {"list effects", "list effects --markdown"}) {
    for (const char* part : {"except:", "only_pairs: true", "pairs:"}) {
      EXPECT_TRUE(holds(run(list).text, part)) << list << " " << part;
    }
  }
}

TEST_F(CliTest, ChecksEverySceneOfTheRepository) {
  int scenes = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(PLIANT_SOURCE_DIR) + "/config/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    const Outcome outcome = run("check --steps 0 " + entry.path().string());
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_FALSE(holds(outcome.text, "warning")) << outcome.text;
  }
  EXPECT_GE(scenes, 6);
}

TEST_F(CliTest, ARunTellsItsTimeIntegrationAndItsStepsOfFirstOrder) {
  const std::string scene =
      std::string(PLIANT_SOURCE_DIR) + "/config/scenes/small_hanging_cloth.yaml";
  const Outcome plain = run("run --steps 5 " + scene);
  EXPECT_TRUE(holds(plain.text, ", by implicit_euler")) << plain.text;
  EXPECT_FALSE(holds(plain.text, "at first order")) << plain.text;
  const Outcome outcome = run("run --steps 5 --time-integration bdf2 " + scene);
  EXPECT_TRUE(holds(outcome.text, ", by bdf2,")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "at first order: cloth: start in 1 step")) << outcome.text;
  const Outcome wrong = run("run --steps 5 --time-integration bdf3 " + scene);
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(holds(wrong.text, "did you mean 'bdf2'")) << wrong.text;
}

TEST_F(CliTest, ListsEveryKindThatItsHelpNames) {
  for (const std::string kind : {"solvers", "time_integrations", "integrators", "effects", "models",
                                 "geometries", "fabrics", "attachments", "obstacles", "elements"}) {
    EXPECT_TRUE(holds(run("list --help").text, kind)) << kind;
    const Outcome outcome = run(std::string("list ") + kind);
    EXPECT_EQ(outcome.code, 0) << outcome.text;
    EXPECT_GT(outcome.text.size(), 100u) << outcome.text;
  }
  const Outcome wrong = run("list fabric");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(holds(wrong.text, "fabrics")) << wrong.text;
}

TEST_F(CliTest, ABatchWritesARowAScene) {
  const std::string table = files_.write("table.csv",
                                         "bodies[0].velocity,solver.iterations\n"
                                         "\"[0, 0, 1]\",5\n\"[0, 0, -1]\",7\n");
  const std::string out = files_.path("out");
  const Outcome outcome =
      run("run " + scene_ + " --steps 6 --every 3 --vary " + table + " --out " + out);
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "2 scenes")) << outcome.text;
  const std::string rows = contents(out + "/scenes.csv");
  EXPECT_EQ(rows.rfind("scene,bodies[0].velocity,solver.iterations,body,step,time,", 0), 0u);
  EXPECT_TRUE(holds(rows, "\n0,\"[0, 0, 1]\",5,towel,3,0.015,5,")) << rows;
  EXPECT_TRUE(holds(rows, "\n1,\"[0, 0, -1]\",7,towel,6,0.03,7,")) << rows;
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 5);
  // 2 scenes, 20 vertices.
  EXPECT_GE(contents(out + "/positions_towel.npy").size(), 2 * 20 * 3 * sizeof(double));
  const Outcome again = run("run " + scene_ + " --steps 6 --batch 2 --out " + out);
  EXPECT_EQ(again.code, 2);
  EXPECT_TRUE(holds(again.text, "--overwrite")) << again.text;
}

/// Rows of a CSV table without quoted cells, each by the names of its columns.
std::vector<std::map<std::string, std::string>> table_rows(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    if (names.empty()) {
      names = cells;
      continue;
    }
    rows.emplace_back();
    for (std::size_t k = 0; k < cells.size(); ++k) rows.back()[names.at(k)] = cells[k];
  }
  return rows;
}

TEST_F(CliTest, ABatchTellsTheWrenchesThatItsScenesTellAlone) {
  // The towel lies on the ground from the first step on.
  files_.write("scene.yaml",
               replaced(kFullScene, "position: [0, 0, 1]", "position: [0, 0, 0.001]"));
  const std::string key = "bodies[0].material.areal_density";
  const std::string table = files_.write("table.csv", key + "\n0.1\n0.4\n");
  const std::string out = files_.path("out");
  ASSERT_EQ(run("run " + scene_ + " --steps 12 --vary " + table + " --out " + out).code, 0);
  const auto rows = table_rows(contents(out + "/scenes.csv"));
  ASSERT_EQ(rows.size(), 2u);
  std::vector<double> forces;
  for (const auto& row : rows) {
    const std::string density = row.at(key);
    files_.write("scene.yaml",
                 replaced(replaced(kFullScene, "position: [0, 0, 1]", "position: [0, 0, 0.001]"),
                          "areal_density: 0.2", "areal_density: " + density));
    const std::string own = files_.path("alone" + density);
    ASSERT_EQ(run("run " + scene_ + " --steps 12 --every 0 --out " + own).code, 0);
    const auto alone = table_rows(contents(own + "/steps.csv"));
    ASSERT_EQ(alone.size(), 12u);
    int wrenches = 0;
    for (const auto& [name, cell] : row) {
      if (name.find(".force_") == std::string::npos && name.find(".torque_") == std::string::npos) {
        continue;
      }
      ++wrenches;
      EXPECT_EQ(cell, alone.back().at(name)) << name;
    }
    EXPECT_EQ(wrenches, 6 * 3);
    forces.push_back(std::stod(row.at("ground.force_z")));
  }
  EXPECT_LT(forces[0], -0.1);
  EXPECT_LT(forces[1], 2.0 * forces[0]);
}

TEST_F(CliTest, ABatchIsRefusedBeforeItRuns) {
  const std::string table = files_.write("table.csv", "time_step\n0.01\n-1\n");
  for (const auto& [arguments, word] : std::vector<std::pair<std::string, std::string>>{
           {"--batch 0", "--batch is 0"},
           {"--batch 3 --vary " + table, "2 rows"},
           {"--rows 0:1", "give --vary TABLE"},
           {"--resume", "give --vary TABLE"},
           {"--trajectory every:1", "--vary TABLE"},
           {"--memory 5", "give --vary TABLE"},
           {"--batch 2 --rows 1", "--rows is '1'"},
           {"--batch 2 --rows 1:3", "0 <= A < B <= 2"},
           {"--batch 2 --rows 1:1", "--rows is '1:1'"},
           {"--batch 2 --rows x:2", "--rows is 'x:2'"},
           {"--batch 2 --memory 0", "--memory is 0"},
           {"--batch 2 --resume", "give --out DIR"},
           {"--batch 2 --trajectory every:0", "every:0"},
           {"--batch 2 --trajectory every:1 fields:x", "unknown field 'x'"},
           {"--batch 2 --trajectory fields:points", "'every:N' is missing"},
           {"--batch 2 --trajectory often", "write every:N"},
           {"--batch 2 --every -1", "--every is -1"},
           {"--vary /none.csv", "/none.csv"}}) {
    const Outcome outcome = run("run " + scene_ + " --steps 1 " + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, word)) << outcome.text;
  }
}

/// A table of six scenes, of which the second is refused.
std::string mixed_table() {
  std::string table = "bodies[0].material.areal_density\n";
  for (const char* density : {"0.1", "-1", "0.3", "0.4", "0.5", "0.6"}) {
    table += std::string(density) + "\n";
  }
  return table;
}

TEST_F(CliTest, ARefusedRowStopsNoOther) {
  const std::string table = files_.write("table.csv", mixed_table());
  const std::string out = files_.path("out");
  const Outcome outcome = run("run " + scene_ + " --steps 2 --vary " + table + " --out " + out);
  EXPECT_EQ(outcome.code, 3);
  EXPECT_TRUE(holds(outcome.text, "error: scene 1: ")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "0 stopped, 1 refused")) << outcome.text;
  const std::string rows = contents(out + "/scenes.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 7);
  // Six cells of each of two obstacles at least; the reason stands in the last column.
  EXPECT_TRUE(holds(rows, "\n1,-1,,,,,,,,,,,,,,,,,,,")) << rows;
  EXPECT_TRUE(holds(rows, ",\"" + table + ":3: ")) << rows;
  // Where none is accepted, nothing is written.
  files_.write("none.csv", "time_step\n-1\n-2\n");
  const Outcome none =
      run("run " + scene_ + " --steps 2 --vary " + files_.path("none.csv") + " --out " + out + "2");
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(holds(none.text, "none.csv:2")) << none.text;
  EXPECT_FALSE(std::filesystem::exists(out + "2"));
}

TEST_F(CliTest, WhatABatchWritesDependsNeitherOnGroupsNorOnShards) {
  const std::string command =
      "run " + scene_ + " --steps 6 --every 3 --vary " + files_.write("table.csv", mixed_table()) +
      " --trajectory every:2 fields:positions,velocities,points,wrenches --out ";
  const std::string all = files_.path("all");
  EXPECT_EQ(run(command + all).code, 3);
  const auto whole = files_in(all);
  EXPECT_EQ(whole.size(), 7u);  // 20 vertices, 4 frames, 6 scenes; after a header of 256 bytes
  EXPECT_EQ(whole.at("trajectory_towel_points.npy").size(), 256u + 6 * 4 * 20 * 3 * 8);
  EXPECT_EQ(run(command + files_.path("small") + " --memory 0.001 --threads 2").code, 3);
  EXPECT_EQ(files_in(files_.path("small")), whole);
  std::string rows, positions;
  for (const char* range : {"0:2", "2:3", "3:"}) {
    const std::string shard = files_.path(std::string("shard") + range[0]);
    run(command + shard + " --rows " + range);
    const auto files = files_in(shard);
    const std::string& own = files.at("scenes.csv");
    rows += rows.empty() ? own : own.substr(own.find('\n') + 1);
    positions += files.at("trajectory_towel_positions.npy").substr(256);
  }
  EXPECT_EQ(rows, whole.at("scenes.csv"));
  EXPECT_EQ(positions, whole.at("trajectory_towel_positions.npy").substr(256));
}

TEST_F(CliTest, ABatchThatWasCutOffGoesOn) {
  const std::string command =
      "run " + scene_ + " --steps 3 --vary " + files_.write("table.csv", mixed_table()) +
      " --solver verlet --set max_substeps=1 --time-step 0.0065 --trajectory every:1 --out ";
  const std::string all = files_.path("all"), cut = files_.path("cut");
  run(command + all);
  run(command + cut + " --resume");  // which begins what is not there
  const auto whole = files_in(all);
  EXPECT_EQ(files_in(cut), whole);
  // As a crash leaves it amid the fourth scene: rows and numbers that do not count yet.
  const std::string rows = whole.at("scenes.csv");
  std::size_t bytes = 0;
  for (int line = 0; line < 4; ++line) bytes = rows.find('\n', bytes) + 1;
  const std::string warnings = whole.at("warnings.csv");  // of the first scene alone
  std::string notes = contents(cut + "/batch.yaml");
  notes.replace(notes.find("finished"), std::string::npos,
                "finished: 3\nbytes: " + std::to_string(bytes) +
                    "\nbytes_1: " + std::to_string(warnings.size()) + "\n");
  files_.write("cut/batch.yaml", notes);
  files_.write("cut/scenes.csv", rows.substr(0, bytes + 17));
  const Outcome outcome = run(command + cut + " --resume");
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, ": 3 scenes, ")) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "warning (1 scene): towel: unstable_step")) << outcome.text;
  EXPECT_EQ(files_in(cut), whole);
  // Not with other steps, nor with another table.
  for (const std::string other : {"--steps 4 --batch 6", "--steps 3 --batch 6"}) {
    const Outcome refused = run("run " + scene_ + " " + other + " --out " + cut + " --resume");
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(holds(refused.text, "of another scene, table")) << refused.text;
  }
  EXPECT_EQ(run(command + cut + " --resume --overwrite").code, 2);
  EXPECT_EQ(files_in(cut), whole);
}

TEST_F(CliTest, FramesAloneAreRefusedWhereThereAreNone) {
  const std::string out = " --out " + files_.path("out");
  for (const auto& [arguments, word] : std::vector<std::pair<std::string, std::string>>{
           {"", "give --out DIR"},
           {out + " --batch 2", "leave --batch and --vary out"},
           {out + " --every 0", "--every 0 writes none"}}) {
    const Outcome outcome = run("run " + scene_ + " --steps 1 --frames-alone" + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, word)) << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(files_.path("out"))) << arguments;
  }
  const Outcome outcome = run("run " + scene_ + " --steps 1 --surface-alone" + out);
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(holds(outcome.text, "--surface-alone is for --frames-alone")) << outcome.text;
}

TEST_F(CliTest, ASceneThatStopsEndsABatchWithCode3) {
  const std::string table = files_.write(
      "table.csv",
      "limits.max_speed,bodies[0].velocity\n1000,\"[0, 0, 0]\"\n10,\"[0, 0, -9.99]\"\n");
  const std::string out = files_.path("out");
  const Outcome outcome =
      run("run " + scene_ + " --steps 4 --vary " + table + " --out " + out + " --set iterations=1");
  EXPECT_EQ(outcome.code, 3) << outcome.text;
  EXPECT_TRUE(holds(outcome.text, "scene 1: ")) << outcome.text;
  EXPECT_TRUE(holds(contents(out + "/scenes.csv"), "limits:")) << contents(out + "/scenes.csv");
}

}  // namespace
}  // namespace pliant
