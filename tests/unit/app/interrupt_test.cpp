// A real Ctrl-C: nothing half-written, and the same command goes on.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

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
      if (entry.is_regular_file()) names.push_back(fs::relative(entry.path(), folder));
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

}  // namespace
}  // namespace pliant
