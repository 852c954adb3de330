#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/interrupt.h"
#include "pliant/app/plot.h"
#include "pliant/app/progress_bar.h"
#include "pliant/math/error.h"
#include "pliant/study/generated/stability_study.h"

namespace pliant {
namespace {

constexpr int kMostScenes = 1'000'000;
constexpr int kMostJobs = 1024;

struct StabilityCommand {
  StabilityOptions study;
  std::string scene;
  bool progress = false;
};

std::string finger() {
  const std::string robot = find_shared("config/robots/finger.urdf");
  if (robot.empty()) throw InputError("config/robots/finger.urdf was not found");
  return robot;
}

void check_range(const std::string& name, int value, int most) {
  if (value >= 1 && value <= most) return;
  throw InputError(fmt::format("{} is {}, but must be from 1 to {}", name, value, most));
}

int count_of(const std::vector<TriedScene>& scenes, SceneFate fate) {
  return static_cast<int>(std::count_if(scenes.begin(), scenes.end(), [&](const TriedScene& scene) {
    return scene.outcome.fate == fate;
  }));
}

/// A scene of the study again, and how it fares.
int try_one(const std::string& text) {
  const std::string robot = finger();
  const SceneChoice choice = choice_of(text, "--scene");
  fmt::print("{}", scene_text(choice, {}, robot));
  const SceneOutcome outcome = try_scene(choice, robot, SceneCare::kThorough);
  fmt::print("# {}{}{}{}\n", to_string(outcome.fate), outcome.oracle.empty() ? "" : ": ",
             outcome.oracle, outcome.message.empty() ? "" : ": " + outcome.message);
  std::fflush(stdout);
  return outcome.fate == SceneFate::kFailed ? kNoAnswer : kOk;
}

int study_all(StabilityCommand command) {
  if (command.study.folder.empty()) throw InputError("--out or --scene is needed");
  check_range("--scenes", command.study.scenes, kMostScenes);
  check_range("--jobs", command.study.jobs, kMostJobs);
  command.study.robot = finger();
  std::error_code error;
  std::filesystem::create_directories(command.study.folder, error);
  if (error) {
    throw InputError(
        fmt::format("cannot make folder '{}': {}", command.study.folder, error.message()));
  }
  catch_interrupts();
  ProgressBar bar(command.progress || isatty(STDERR_FILENO) != 0);
  const std::vector<TriedScene> scenes = study_stability(command.study, [&](int done, int of) {
    bar.update(done, of, "scenes");
    return !interrupted();
  });
  bar.clear();
  const int failed = count_of(scenes, SceneFate::kFailed);
  fmt::print("{} scenes: {} stable, {} recovered, {} refused, {} failed; tables in {}\n",
             scenes.size(), count_of(scenes, SceneFate::kStable),
             count_of(scenes, SceneFate::kRecovered), count_of(scenes, SceneFate::kRefused), failed,
             command.study.folder);
  std::fflush(stdout);
  if (interrupted()) {
    std::cerr << "interrupted: the tables are of these scenes\n";
    return kInterrupted;
  }
  return failed == 0 ? kOk : kNoAnswer;
}

}  // namespace

void add_stability_command(CLI::App& study, int& exit_code) {
  CLI::App* command =
      add_command(study, "stability", "Try generated scenes, and see which break a law of physics");
  command->footer("More in docs/stability.md.\n\n" + command->get_footer());
  auto options = std::make_shared<StabilityCommand>();
  command->add_option("--out", options->study.folder, "Folder for tables and what failed")
      ->type_name("DIR");
  command->add_option("--scenes", options->study.scenes, "How many [20000]");
  command->add_option("--seed", options->study.seed, "Of what is chosen by chance [1]");
  command->add_option("--jobs", options->study.jobs, "Processes at a time [1]");
  command
      ->add_option("--scene", options->scene,
                   "One scene alone, by its line in a .scene file: prints it and how it fares")
      ->type_name("TEXT");
  command->add_flag("--progress", options->progress,
                    "Show the bar where stderr is no terminal too");
  command->callback([options, &exit_code] {
    exit_code = options->scene.empty() ? study_all(*options) : try_one(options->scene);
  });
}

}  // namespace pliant
