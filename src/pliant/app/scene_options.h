#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pliant/scene/scene.h"

namespace pliant {

/// The arguments that say which scene to load and what to change in it.
struct SceneOptions {
  std::string path;
  std::optional<std::string> solver;
  std::vector<std::string> settings;  ///< "key=value"
  std::optional<std::string> time_integration;
  std::optional<double> time_step;  ///< [s]
  std::optional<int> threads;
};

void add_scene_options(CLI::App& command, SceneOptions& options);

/// What the arguments change in the scene. Throws InputError.
SceneOverrides scene_overrides(const SceneOptions& options);

/// Loads the scene and prints its warnings to stderr. Throws InputError.
LoadedScene load_scene(const SceneOptions& options);
/// Likewise with more that is changed.
LoadedScene load_scene(const SceneOptions& options, const SceneOverrides& overrides);

}  // namespace pliant
