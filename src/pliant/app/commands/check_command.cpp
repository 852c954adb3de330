#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/scene_options.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr int kMostSteps = 1'000'000;

struct CheckOptions {
  SceneOptions scene;
  int steps = 20;
};

/// The last text of each kind of warning that a trial run gives: a kind is what stands before the
/// first colon of the text, whose figures change from step to step.
class TrialWarnings {
 public:
  void add(const World& world) {
    for (const Body& body : world.bodies()) {
      for (const std::string& text : body.report.warnings) {
        last_[{body.name, text.substr(0, text.find(':'))}] = text;
      }
    }
  }
  void print(const std::string& path, int steps) const {
    for (const auto& [kind, text] : last_) {
      std::cerr << fmt::format("warning: {}: in the first {} steps: {}: {}\n", path, steps,
                               kind.first, text);
    }
  }
  std::size_t size() const { return last_.size(); }

 private:
  std::map<std::pair<std::string, std::string>, std::string> last_;
};

int check(const CheckOptions& options) {
  if (options.steps < 0 || options.steps > kMostSteps) {
    throw InputError(
        fmt::format("--steps is {}, but must be from 0 to {}", options.steps, kMostSteps));
  }
  const std::string& path = options.scene.path;
  LoadedScene scene = load_scene(options.scene);
  for (const std::string& note : scene.notes) std::cout << path << ": " << note << '\n';
  TrialWarnings trial;
  bool is_finite = true;
  for (int k = 0; k < options.steps && is_finite; ++k) {
    is_finite = scene.world->step();
    trial.add(*scene.world);
  }
  trial.print(path, options.steps);
  if (!is_finite) {
    std::cerr << "error: " << path << ": " << scene.world->failure() << std::endl;
    return kNotFinite;
  }
  const std::size_t warnings = scene.warnings.size() + trial.size();
  const std::string others =
      warnings == 0 ? "" : fmt::format(", with {} warning{}", warnings, warnings == 1 ? "" : "s");
  std::cout << path << ": OK" << others << std::endl;
  return kOk;
}

}  // namespace

void add_check_command(CLI::App& app, int& exit_code) {
  CLI::App* command = add_command(
      app, "check",
      "Check a scene and every file that it names, and what its first steps warn of; print OK or "
      "what is wrong");
  auto options = std::make_shared<CheckOptions>();
  add_scene_options(*command, options->scene);
  command
      ->add_option("--steps", options->steps,
                   "Steps of a trial, whose warnings are told; 0: only the files are checked")
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = check(*options); });
}

}  // namespace pliant
