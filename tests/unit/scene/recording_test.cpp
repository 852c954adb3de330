#include "pliant/scene/recording.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "pliant/geometry/io/mesh_file.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

std::vector<std::vector<std::string>> read_csv(const std::string& path) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

class RecordingTest : public ::testing::Test {
 protected:
  RecordingTest() : scene_(load_scene(write_scene(files_, kFullScene))) {}
  void record(Recording& recording, int steps) {
    recording.add_frame(*scene_.world);
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(scene_.world->step());
      recording.add_step(*scene_.world);
    }
  }

  SceneFiles files_;
  LoadedScene scene_;
};

TEST_F(RecordingTest, WritesOneRowAStep) {
  Recording recording(files_.path("out"), {}, false);
  record(recording, 3);
  EXPECT_FALSE(fs::exists(files_.path("out/steps.csv")));
  recording.finish();
  EXPECT_FALSE(fs::exists(files_.path("out/steps.csv.part")));
  const auto rows = read_csv(files_.path("out/steps.csv"));
  ASSERT_EQ(rows.size(), 4u);
  const std::vector<std::string> head(rows[0].begin(), rows[0].begin() + 17);
  EXPECT_EQ(head, (std::vector<std::string>{
                      "step", "time", "body", "solver", "time_integration", "first_order",
                      "iterations", "residual", "error", "impulse_imbalance", "energy_gained",
                      "ended_by", "contacts", "kinetic", "elastic", "potential", "step_seconds"}));
  for (const auto& row : rows) EXPECT_EQ(row.size(), rows[0].size());
  EXPECT_EQ(rows[1][0], "1");
  EXPECT_EQ(rows[3][1], "0.015");
  EXPECT_EQ(rows[2][2], "towel");
  EXPECT_EQ(rows[2][3], "xpbd");
  EXPECT_EQ(rows[2][4], "implicit_euler");
  EXPECT_EQ(rows[2][5], "");
  for (const char* phase : {"gravity", "contact", "friction"}) {
    EXPECT_NE(std::find(rows[0].begin(), rows[0].end(), phase), rows[0].end()) << phase;
  }
}

/// The cell of a row in the column `name`; NaN where there is no such column.
double cell_of(const std::vector<std::vector<std::string>>& rows, std::size_t row,
               const std::string& name) {
  const auto found = std::find(rows[0].begin(), rows[0].end(), name);
  if (found == rows[0].end()) return std::nan("");
  return std::stod(rows[row].at(static_cast<std::size_t>(found - rows[0].begin())));
}

TEST_F(RecordingTest, HasTheWrenchOnEachLinkAndObstacle) {
  // A vertex of the towel falls onto the lift's hand.
  scene_ = load_scene(write_scene(
      files_, replaced(kFullScene, "position: [0, 0, 1]", "position: [0.16667, 0, 2.07]")));
  World& world = *scene_.world;
  Recording recording(files_.path("out"), {}, false);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  constexpr int kSteps = 60;
  for (int i = 0; i < kSteps; ++i) {
    ASSERT_TRUE(world.step());
    recording.add_step(world);
    for (const Reaction& reaction : world.reactions()) sum += reaction.force;
  }
  recording.finish();
  const auto rows = read_csv(files_.path("out/steps.csv"));
  ASSERT_EQ(rows.size(), kSteps + 1u);
  ASSERT_LT(sum.z(), -0.1) << "it touches something";
  // No link or obstacle is turned.
  Eigen::Vector3d told = Eigen::Vector3d::Zero();
  for (const Wrench& wrench : zero_wrenches(world.obstacles())) {
    for (std::size_t row = 1; row < rows.size(); ++row) {
      told += Eigen::Vector3d(cell_of(rows, row, wrench.name + ".force_x"),
                              cell_of(rows, row, wrench.name + ".force_y"),
                              cell_of(rows, row, wrench.name + ".force_z"));
    }
  }
  EXPECT_LT((told - sum).norm(), 1e-12 * sum.norm() * kSteps);
  EXPECT_EQ(cell_of(rows, 1, "ground.torque_x"), 0.0) << "before anything touches";
  const auto first_phase = std::find(rows[0].begin(), rows[0].end(), "gravity");
  EXPECT_EQ(first_phase - rows[0].begin(), 17 + 6 * 3) << "one link and two obstacles";
}

TEST_F(RecordingTest, LeavesOutTheStepsBetweenFramesWhereTold) {
  RecordingSpec options;
  options.every = 3;
  options.frames_alone = true;
  Recording recording(files_.path("out"), options, false);
  EXPECT_EQ(recording.steps_between(), 3);
  record(recording, 7);
  recording.finish();
  const auto rows = read_csv(files_.path("out/steps.csv"));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[1][0], "3");
  EXPECT_EQ(rows[2][0], "6");
  EXPECT_EQ(recording.frames(), 3);
}

TEST_F(RecordingTest, LeavesOutAllButTheSurfaceWhereTold) {
  std::map<bool, std::string> frames;
  for (const bool alone : {false, true}) {
    scene_.world->reset();
    RecordingSpec options;
    options.every = 2;
    options.surface_alone = alone;
    const std::string out = files_.path(alone ? "alone" : "whole");
    Recording recording(out, options, false);
    EXPECT_EQ(recording.readback(), alone ? Readback::kSurface : Readback::kMotion);
    record(recording, 2);
    recording.finish();
    frames[alone] = out + "/frames/towel_000002.ply";
    const auto rows = read_csv(out + "/steps.csv");
    for (const int column : {13, 14, 15}) {
      EXPECT_EQ(rows[1][static_cast<std::size_t>(column)].empty(), alone)
          << rows[0][static_cast<std::size_t>(column)];
    }
    EXPECT_EQ(rows[1].size(), rows[0].size());
  }
  EXPECT_EQ(read_triangle_mesh(frames[true]).vertices, read_triangle_mesh(frames[false]).vertices);
  EXPECT_LT(fs::file_size(frames[true]), fs::file_size(frames[false]));
}

TEST_F(RecordingTest, PhasesMetLaterGetColumnsInEveryRow) {
  Recording recording(files_.path("out"), {}, false);
  record(recording, 1);
  ASSERT_TRUE(scene_.world->step());
  scene_.world->bodies()[0].report.add_time("late", 0.5);
  recording.add_step(*scene_.world);
  recording.finish();
  const auto rows = read_csv(files_.path("out/steps.csv"));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].back(), "late");
  EXPECT_EQ(rows[1].back(), "0");
  EXPECT_EQ(rows[2].back(), "0.5");
  EXPECT_EQ(rows[1].size(), rows[0].size());
}

TEST_F(RecordingTest, WritesFramesWhenDue) {
  for (const FrameFormat format : {FrameFormat::kPly, FrameFormat::kObj}) {
    const std::string ending = format == FrameFormat::kPly ? ".ply" : ".obj";
    scene_.world->reset();
    RecordingSpec options;
    options.every = 2;
    options.format = format;
    Recording recording(files_.path("out" + ending), options, false);
    record(recording, 5);
    EXPECT_EQ(recording.frames(), 3);
    for (const char* step : {"000000", "000002", "000004"}) {
      const TriangleMesh mesh =
          read_triangle_mesh(files_.path("out" + ending + "/frames/towel_" + step + ending));
      EXPECT_EQ(mesh.vertices.cols(), 20);
    }
    recording.add_frame(*scene_.world);
    recording.add_frame(*scene_.world);
    EXPECT_EQ(recording.frames(), 4);
  }
}

TEST_F(RecordingTest, WritesNoFramesUnlessAsked) {
  Recording recording(files_.path("out"), {}, false);
  record(recording, 2);
  EXPECT_EQ(recording.frames(), 0);
  EXPECT_TRUE(fs::is_empty(files_.path("out/frames")));
}

TEST_F(RecordingTest, DestructionFinishes) {
  { Recording(files_.path("out"), {}, false).add_frame(*scene_.world); }
  EXPECT_EQ(read_csv(files_.path("out/steps.csv")).size(), 1u);
}

TEST_F(RecordingTest, NeverMixesTwoRecordings) {
  RecordingSpec options;
  options.every = 1;
  {
    Recording recording(files_.path("out"), options, false);
    record(recording, 3);
  }
  files_.write("out/notes.txt", "mine");
  expect_refusal([&] { Recording(files_.path("out"), options, false); },
                 {files_.path("out"), "is there already"});
  EXPECT_TRUE(fs::exists(files_.path("out/steps.csv")));
  scene_.world->reset();
  Recording(files_.path("out"), options, true).add_frame(*scene_.world);
  EXPECT_FALSE(fs::exists(files_.path("out/frames/towel_000003.ply")));
  EXPECT_TRUE(fs::exists(files_.path("out/frames/towel_000000.ply")));
  EXPECT_TRUE(fs::exists(files_.path("out/notes.txt")));
}

TEST_F(RecordingTest, WritesThroughNoLink) {
  files_.write("precious.txt", "mine");
  for (const char* name : {"steps.csv", "steps.csv.part", "frames/towel_000000.ply"}) {
    // One that leads nowhere is no free place either, and nothing appears where it leads.
    for (const char* target : {"precious.txt", "elsewhere"}) {
      const SceneFiles out;
      fs::create_directories(out.path("frames"));
      fs::create_symlink(files_.path(target), out.path(name));
      for (const bool overwrite : {false, true}) {
        expect_refusal([&] { Recording(out.path("."), {}, overwrite); },
                       {name, "no recording wrote it"});
      }
      EXPECT_TRUE(fs::is_symlink(out.path(name)));
    }
  }
  EXPECT_EQ(read_csv(files_.path("precious.txt"))[0][0], "mine");
  EXPECT_FALSE(fs::exists(files_.path("elsewhere")));
}

TEST_F(RecordingTest, OverwritesItsOwnFilesAlone) {
  for (const FrameFormat format : {FrameFormat::kPly, FrameFormat::kObj}) {
    const SceneFiles out;
    RecordingSpec options;
    options.every = 1;
    options.format = format;
    const std::vector<std::string> kept = {"frames/mine.obj", "frames/part_12.ply",
                                           "frames/notes.txt", "frames/000001.ply", "notes.txt"};
    for (const std::string& name : kept) out.write(name, "mine");
    {
      scene_.world->reset();
      Recording recording(out.path("."), options, false);
      record(recording, 2);
    }
    const std::string ending = format == FrameFormat::kPly ? ".ply" : ".obj";
    const std::string frame = out.path("frames/towel_000002" + ending);
    EXPECT_TRUE(fs::exists(frame));
    { Recording(out.path("."), options, true); }
    EXPECT_FALSE(fs::exists(frame));
    for (const std::string& name : kept) EXPECT_TRUE(fs::exists(out.path(name))) << name;
    // A user's own with a frame's name, a frame under another name, and another table.
    { Recording(out.path("."), options, true).add_frame(*scene_.world); }
    const std::string own = "frames/hand_000001" + ending;
    for (const auto& put : std::vector<std::function<void()>>{
             [&] { out.write(own, "ply\n"); }, [&] { fs::copy_file(frame, out.path(own)); }}) {
      put();
      expect_refusal([&] { Recording(out.path("."), options, true); },
                     {own, "no recording wrote it", "move it away"});
      EXPECT_TRUE(fs::exists(frame)) << "nothing is removed before all is known";
      fs::remove(out.path(own));
    }
    out.write("steps.csv", "step,mine\n1,2\n");
    expect_refusal([&] { Recording(out.path("."), options, true); },
                   {"steps.csv", "no recording wrote it"});
  }
}

TEST_F(RecordingTest, EachStepIsInItsFileAsSoonAsItIsDone) {
  Recording recording(files_.path("out"), {}, false);
  for (std::size_t step = 1; step <= 3; ++step) {
    record(recording, 1);
    const auto rows = read_csv(files_.path("out/steps.csv.part"));
    ASSERT_EQ(rows.size(), step + 1);
    EXPECT_EQ(rows[0][2], "body");
    EXPECT_EQ(rows[step].size(), rows[0].size());
    EXPECT_EQ(rows[step][0], std::to_string(step));
  }
  EXPECT_FALSE(fs::exists(files_.path("out/steps.csv")));
}

TEST_F(RecordingTest, HasItsFolderForItself) {
  {
    const Recording first(files_.path("out"), {}, false);
    expect_refusal([&] { Recording(files_.path("out"), {}, true); },
                   {files_.path("out"), "another one is at work there"});
  }
  Recording(files_.path("out"), {}, true);
}

TEST_F(RecordingTest, RefusesAFolderThatCannotBe) {
  files_.write("file", "x");
  expect_refusal([&] { Recording(files_.path("file"), {}, false); }, {files_.path("file")});
  expect_refusal([&] { Recording(files_.path("file/below"), {}, false); }, {files_.path("file")});
}

}  // namespace
}  // namespace pliant
