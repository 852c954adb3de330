#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "pliant/study/accuracy/accuracy_plan.h"

namespace pliant {

/// A number that differs when anything differs that a scene says or that a file which it names
/// holds; but for its name, description, solver, threads and recording, which do not change what a
/// study measures. Meshes that a URDF names are not read for it. Throws InputError.
std::uint64_t scene_hash(const SceneSpec& scene);

/// The settings of a study as YAML: two studies whose texts are equal measure the same rows.
std::string settings_text(const AccuracyPlan& plan);

/// The options that settings_text() wrote, if they are of a study of the scene with `hash` and its
/// time step. Throws InputError for text that is no such settings.
std::optional<AccuracyOptions> options_from_settings(const std::string& text,
                                                     const std::string& file, std::uint64_t hash);

}  // namespace pliant
