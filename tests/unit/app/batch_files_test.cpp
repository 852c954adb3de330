// What a batch keeps beside the rows of its scenes: contacts, and states for --resume.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <sstream>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

class BatchFiles : public testing::Test {
 protected:
  /// A towel that falls on a ball and the ground, and a link that is moved meanwhile.
  BatchFiles()
      : scene_(write_scene(files_, replaced(replaced(kFullScene, "[0, 0, 1]", "[0, 0, 0.12]"),
                                            "    fixed: [{corner: lower_left}]\n", ""))),
        table_(files_.write("t.csv", "bodies[0].material.areal_density\n0.1\n-1\n0.3\n0.4\n")) {}

  std::vector<std::string> command(const std::string& out, const std::string& more) const {
    std::istringstream words("run " + scene_ + " --vary " + table_ + " --out " + files_.path(out) +
                             " --trajectory every:20 fields:positions,contacts " + more);
    return {std::istream_iterator<std::string>(words), {}};
  }
  Outcome run_batch(const std::string& out, const std::string& more) const {
    std::string text;
    for (const std::string& word : command(out, more)) text += " " + word;
    return run(text);
  }
  std::string file(const std::string& out, const std::string& name) const {
    return contents(files_.path(out + "/" + name));
  }

  SceneFiles files_;
  std::string scene_, table_;
};

TEST_F(BatchFiles, ContactsAreRowsThatDependNeitherOnGroupsNorOnShards) {
  ASSERT_EQ(run_batch("all", "--steps 60").code, 3);  // a row is refused
  const std::string all = file("all", "trajectory_contacts.csv");
  EXPECT_EQ(all.substr(0, 45), "scene,frame,time,body,vertex,other,point_x,po");
  EXPECT_TRUE(holds(all, "\n0,3,0.3")) << all;
  EXPECT_TRUE(holds(all, ",ground,")) << all;
  EXPECT_FALSE(holds(all, "\n1,")) << all;  // the refused one
  EXPECT_TRUE(holds(all, "\n3,3,0.3")) << all;
  run_batch("small", "--steps 60 --memory 0.001 --threads 2");
  EXPECT_EQ(file("small", "trajectory_contacts.csv"), all);
  run_batch("first", "--steps 60 --rows :2");
  run_batch("last", "--steps 60 --rows 2:");
  const std::string last = file("last", "trajectory_contacts.csv");
  EXPECT_EQ(file("first", "trajectory_contacts.csv") + last.substr(last.find('\n') + 1), all);
}

TEST_F(BatchFiles, ScenesThatWereCutOffGoOnFromTheirStates) {
  const std::string steps =  // which warns
      "--steps 3000 --every 500 --quiet --solver verlet --set max_substeps=1 --time-step 0.0065";
  ASSERT_EQ(run_batch("all", steps).code, 3);
  const std::string state = files_.path("cut/unfinished.state");
  const Outcome killed = run_until(command("cut", steps + " --checkpoint 0.001"),
                                   files_.path("log"), SIGKILL, [&] { return fs::exists(state); });
  ASSERT_EQ(killed.code, -SIGKILL) << killed.text;
  const std::string kept = contents(state);
  EXPECT_TRUE(holds(kept, "unstable_step"));
  // One that is damaged is refused, and so is anything else.
  for (const std::string& bad : {kept.substr(0, kept.size() - 9), std::string("state"),
                                 replaced(kept, "Pliant state", "Pliant stare")}) {
    files_.write("cut/unfinished.state", bad);
    const Outcome refused = run_batch("cut", steps + " --resume");
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(holds(refused.text, "it is damaged")) << refused.text;
  }
  files_.write("cut/unfinished.state", kept);
  EXPECT_EQ(run_batch("cut", steps + " --resume").code, 3);
  for (const char* name : {"scenes.csv", "positions_towel.npy", "trajectory_towel_positions.npy",
                           "trajectory_contacts.csv", "warnings.csv"}) {
    EXPECT_EQ(file("cut", name), file("all", name)) << name;
  }
  EXPECT_TRUE(holds(file("all", "warnings.csv"), "0,\"towel: unstable_step: "));
  EXPECT_FALSE(fs::exists(state));
}

TEST_F(BatchFiles, StatesAreOfBatchesThatWriteFiles) {
  const std::string command = "run " + scene_ + " --steps 1 ";
  for (const auto& [arguments, words] : std::vector<std::pair<std::string, std::string>>{
           {"--checkpoint 1", "--checkpoint is for many scenes"},
           {"--batch 2 --checkpoint 1", "give --out DIR"},
           {"--batch 2 --checkpoint 0 --out " + files_.path("x"), "--checkpoint is 0"}}) {
    const Outcome outcome = run(command + arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_TRUE(holds(outcome.text, words)) << outcome.text;
  }
}

TEST_F(BatchFiles, DescribeTellsNumbersAndWhatIsAllowed) {
  const Outcome known = run("describe " + scene_ +
                            " --value bodies[0].material.bending effects.friction.coefficient "
                            "obstacles[ground].friction obstacles[1].friction time_step "
                            "bodies[0].position");
  EXPECT_EQ(known.code, 0);
  for (const char* row :
       {"bodies[0].material.bending,1e-05,0,1,1000,N m,", "effects.friction.coefficient,0.4,0,1,",
        "obstacles[ground].friction,0.3,0,1,", "obstacles[1].friction,",
        "time_step,0.005,0,0,inf,s", "bodies[0].position,,,,,,"}) {
    EXPECT_TRUE(holds(known.text, row)) << row << "\n" << known.text;
  }
  for (const auto& [path, words] : std::vector<std::pair<std::string, std::string>>{
           {"bodies[0].material.bendin", "did you mean 'bending'"},
           {"bodies[towl].material.bending", "did you mean 'towel'"},
           {"effects.fricton.coefficient", "did you mean 'friction'"},
           {"obstacles[bal].friction", "did you mean 'ball'"}}) {
    const Outcome refused = run("describe " + scene_ + " --value " + path);
    EXPECT_EQ(refused.code, 2);
    EXPECT_TRUE(holds(refused.text, words)) << refused.text;
  }
}

}  // namespace
}  // namespace pliant
