#include "pliant/app/scene_options.h"

#include <fmt/format.h>

#include <iostream>

#include "pliant/math/error.h"
#include "pliant/scene/file_access.h"

namespace pliant {
namespace {

ParameterText parse_settings(const std::vector<std::string>& settings) {
  ParameterText parameters;
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw InputError("--set " + setting + ": write KEY=VALUE, for example iterations=20");
    }
    parameters[setting.substr(0, equals)] = setting.substr(equals + 1);
  }
  return parameters;
}

}  // namespace

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("scene", options.path, "Scene file (YAML)")->required()->type_name("SCENE");
  command
      .add_option("--solver", options.solver,
                  "Another solver than the scene's; see `pliant list"
                  " solvers`")
      ->type_name("NAME");
  command.add_option("--set", options.settings, "A parameter of the solver; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command
      .add_option("--time-integration", options.time_integration,
                  "Another time integration than the scene's; see `pliant list time_integrations`")
      ->type_name("NAME");
  command.add_option("--time-step", options.time_step, "Another time step than the scene's [s]");
  command.add_option("--threads", options.threads, "Threads a step may use; results stay the same");
  command.add_flag_callback(
      "--allow-outside", allow_files_outside,
      "Let the scene name files outside of its folder, ROS packages and PLIANT_FILE_ROOTS");
}

SceneOverrides scene_overrides(const SceneOptions& options) {
  SceneOverrides overrides;
  overrides.solver = options.solver;
  overrides.solver_parameters = parse_settings(options.settings);
  overrides.time_integration = options.time_integration;
  overrides.time_step = options.time_step;
  overrides.threads = options.threads;
  return overrides;
}

LoadedScene load_scene(const SceneOptions& options) {
  return load_scene(options, scene_overrides(options));
}

LoadedScene load_scene(const SceneOptions& options, const SceneOverrides& overrides) {
  LoadedScene scene = load_scene(options.path, overrides);
  if (scene.mended_meshes > 0) {
    std::cerr << fmt::format(
        "note: {}: {} mesh{} not used as in the file; `pliant check` tells how\n", options.path,
        scene.mended_meshes, scene.mended_meshes == 1 ? " is" : "es are");
  }
  for (const std::string& warning : scene.warnings) {
    std::cerr << "warning: " << options.path << ": " << warning << std::endl;
  }
  return scene;
}

}  // namespace pliant
