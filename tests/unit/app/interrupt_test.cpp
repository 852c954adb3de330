// A real Ctrl-C: nothing half-written, and the same command goes on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "unit/app/program.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr int kInterruptedCode = 130;

class Interrupted : public testing::Test {
 protected:
  /// Names of all files below the folder, in order.
  static std::vector<std::string> files_below(const std::string& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      // A temporary file may be gone by now: its name alone is looked at.
      std::error_code gone;
      if (entry.is_regular_file(gone)) names.push_back(entry.path().lexically_relative(folder));
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  static std::vector<std::string> study(const std::string& folder) {
    return {"study",      "reduced", "--experiment",   "1",    "--bodies", "beam",
            "--duration", "3",       "--displacement", "0.05", "--out",    folder,
            "--no-plot"};
  }
  SceneFiles files_;
};

TEST_F(Interrupted, ReduceGoesOnFromItsFinishedParts) {
  const std::string whole = files_.path("whole.prm"), out = files_.path("out/body.prm");
  fs::create_directories(files_.path("out"));
  ASSERT_EQ(run("reduce tower --modes 12 --rank 20 --out " + whole).code, 0);
  const std::vector<std::string> command = {"reduce", "tower", "--modes", "12",
                                            "--rank", "20",    "--out",   out};
  const std::string modes = out + ".unfinished/parts/modes";
  const Outcome stopped =
      run_until(command, files_.path("log"), SIGINT, [&] { return fs::exists(modes); });
  ASSERT_EQ(stopped.code, kInterruptedCode) << stopped.text;
  EXPECT_TRUE(holds(stopped.text, "goes on from " + out + ".unfinished")) << stopped.text;
  EXPECT_FALSE(fs::exists(out));
  for (const std::string& name : files_below(files_.path("out"))) {
    EXPECT_FALSE(holds(name, ".tmp")) << name;
  }
  const std::string kept = contents(modes);
  ASSERT_EQ(run("reduce tower --modes 12 --rank 20 --out " + out).code, 0);
  EXPECT_EQ(contents(out), contents(whole));
  EXPECT_FALSE(kept.empty());
  EXPECT_EQ(files_below(files_.path("out")), std::vector<std::string>{"body.prm"});
}

TEST_F(Interrupted, StudyGoesOnAfterItsLastFinishedPart) {
  const std::string folder = files_.path("study"), parts = folder + "/parts";
  const auto made = [&] {  // parts beside the settings
    const auto is_part = [](const std::string& name) {
      return name != "settings" && !holds(name, ".tmp");
    };
    const std::vector<std::string> names =
        fs::exists(parts) ? files_below(parts) : std::vector<std::string>();
    return std::count_if(names.begin(), names.end(), is_part);
  };
  const Outcome stopped =
      run_until(study(folder), files_.path("log"), SIGINT, [&] { return made() > 0; });
  ASSERT_EQ(stopped.code, kInterruptedCode) << stopped.text;
  EXPECT_TRUE(holds(stopped.text, "interrupted in experiment 1")) << stopped.text;
  // The table has the parts that were finished, three scales and five integrators each, in whole.
  const std::string first = contents(folder + "/runs_0.csv");
  EXPECT_EQ(std::count(first.begin(), first.end(), '\n') % 15, 1);
  EXPECT_EQ(first.back(), '\n');
  const std::vector<std::string> names = files_below(parts);
  std::vector<std::string> bytes;
  for (const std::string& name : names) {
    EXPECT_FALSE(holds(name, ".tmp")) << name;
    bytes.push_back(contents(parts + "/" + name));
  }
  // Nobody holds the folder any more, and what was finished is taken as it is, times included.
  std::string text;
  for (const std::string& word : study(folder)) text += word + " ";
  const Outcome finished = run(text);
  ASSERT_EQ(finished.code, 0) << finished.text;
  EXPECT_FALSE(holds(finished.text, "afresh")) << finished.text;
  for (std::size_t k = 0; k < names.size(); ++k) {
    EXPECT_EQ(contents(parts + "/" + names[k]), bytes[k]) << names[k];
  }
  const std::string rows = contents(folder + "/runs_0.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 46);
}

TEST_F(Interrupted, TwoStudiesInOneFolderAreRefused) {
  const std::string folder = files_.path("study");
  Outcome second{0, ""};
  const Outcome first = run_until(study(folder), files_.path("log"), SIGINT, [&] {
    if (!fs::exists(folder + "/parts/settings")) return false;
    if (second.code == 0) second = run("study reduced --experiment floor --out " + folder);
    return true;
  });
  EXPECT_EQ(second.code, 2) << second.text;
  EXPECT_TRUE(holds(second.text, "another one is at work there (process ")) << second.text;
  EXPECT_EQ(first.code, kInterruptedCode) << first.text;
}

/// A run that takes minutes, and how many whole lines steps.csv.part has.
class RunStopped : public Interrupted {
 protected:
  std::vector<std::string> command(const std::string& folder) const {
    return {"run",     std::string(PLIANT_SOURCE_DIR) + "/config/scenes/small_hanging_cloth.yaml",
            "--steps", "1000000",
            "--every", "1",
            "--out",   folder};
  }
  static auto lines(const std::string& folder) {
    const std::string rows = contents(folder + "/steps.csv.part");
    return std::count(rows.begin(), rows.end(), '\n');
  }
};

TEST_F(RunStopped, BySignalsThatAreCtrlCToIt) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const std::string folder = files_.path("run_" + std::to_string(signal));
    const Outcome stopped =
        run_until(command(folder), files_.path("log"), signal, [&] { return lines(folder) > 3; });
    EXPECT_EQ(stopped.code, kInterruptedCode) << signal << stopped.text;
    EXPECT_TRUE(holds(stopped.text, "interrupted after step ")) << stopped.text;
    const std::string rows = contents(folder + "/steps.csv");
    // The rows of all steps that were taken, and the last one's frame.
    const auto steps = std::count(rows.begin(), rows.end(), '\n') - 1;
    EXPECT_GT(steps, 2);
    EXPECT_TRUE(fs::exists(fmt::format("{}/frames/cloth_{:06}.ply", folder, steps))) << steps;
    EXPECT_FALSE(fs::exists(folder + "/steps.csv.part"));
  }
}

TEST_F(RunStopped, NotByATerminalThatNohupKeepsFromIt) {
  const std::string folder = files_.path("run");
  std::string text = "nohup " + kProgram;
  for (const std::string& word : command(folder)) text += " " + word;
  const Outcome outcome = run_command(
      "( " + text + " >" + files_.path("log") + " 2>&1 & p=$!; f=" + folder + "/steps.csv.part; " +
      "for n in $(seq 600); do [ -s $f ] && break; sleep 0.02; done; kill -HUP $p; " +
      "wc -c <$f; sleep 0.3; wc -c <$f; kill -INT $p; kill -TERM $p; wait $p; echo $? )");
  std::istringstream words(outcome.text);
  long before = 0, after = 0, code = 0;
  words >> before >> after >> code;
  EXPECT_GT(after, before) << outcome.text;
  EXPECT_EQ(code, kInterruptedCode) << outcome.text;
}

TEST_F(RunStopped, KilledItKeepsWholeStepsAndFrames) {
  for (const long at : {1, 5, 20}) {
    const std::string folder = files_.path("run_" + std::to_string(at));
    const Outcome killed =
        run_until(command(folder), files_.path("log"), SIGKILL, [&] { return lines(folder) > at; });
    EXPECT_EQ(killed.code, -SIGKILL) << killed.text;
    EXPECT_FALSE(fs::exists(folder + "/steps.csv")) << "half a table";
    const std::string rows = contents(folder + "/steps.csv.part");
    ASSERT_EQ(rows.back(), '\n') << "half a row";
    const auto steps = std::count(rows.begin(), rows.end(), '\n') - 1;
    EXPECT_GE(steps, at);
    // Frames follow their rows: at most the last one is missing, and each is whole.
    std::ptrdiff_t frames = 0;
    std::uintmax_t size = 0;
    for (const auto& entry : fs::directory_iterator(folder + "/frames")) {
      if (entry.path().extension() == ".tmp") continue;
      ++frames;
      if (size == 0) size = entry.file_size();
      EXPECT_EQ(entry.file_size(), size) << entry.path();
    }
    EXPECT_GE(frames, steps);
    // What is there is a recording, which is not lost by chance, and nobody holds it any more.
    std::string text;
    for (const std::string& word : command(folder)) text += " " + word;
    const std::string short_run = replaced(text, "1000000", "2");
    EXPECT_EQ(run(short_run).code, 2);
    const Outcome again = run(short_run + " --overwrite");
    EXPECT_EQ(again.code, 0) << again.text;
  }
}

}  // namespace
}  // namespace pliant
