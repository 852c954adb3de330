#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>

#include "pliant/app/commands/commands.h"
#include "pliant/app/scene_options.h"
#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"

namespace pliant {
namespace {

constexpr int kMostSteps = 1'000'000;

struct CheckOptions {
  SceneOptions scene;
  int steps = 20;
};

/// What a scene that names no solver could write for a body that its model's default leaves
/// inaccurate; empty for others.
std::string solver_to_write(const SceneSpec& scene, const Body& body) {
  if (scene.names_solver) return "";
  const std::vector<std::string> names = all_solvers().names_for(std::string(body.model->name()));
  for (const std::string name : {"lbfgs", "newton"}) {
    const bool suits = std::find(names.begin(), names.end(), name) != names.end();
    if (suits && name != body.solver->name()) {
      return fmt::format("; '{}' is the default, to try another write: solver: {{name: {}}}",
                         body.solver->name(), name);
    }
  }
  return "";
}

/// The last text of each kind of warning that a trial run gives: a kind is what stands before the
/// first colon of the text, whose figures change from step to step.
class TrialWarnings {
 public:
  void add(const LoadedScene& scene) {
    for (const Body& body : scene.world->bodies()) {
      for (const std::string& text : body.report.warnings) {
        const std::string kind = text.substr(0, text.find(':'));
        last_[{body.name, kind}] =
            text + (kind == "inaccurate" ? solver_to_write(scene.spec, body) : "");
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
    trial.add(scene);
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
