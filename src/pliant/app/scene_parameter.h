#pragma once

#include <optional>
#include <string>

#include "pliant/scene/scene_spec.h"

namespace pliant {

/// A number of a scene that a registry describes.
struct SceneParameter {
  double value = 0.0;  ///< as the scene has it, be it by default
  ParameterSpec spec;
};

/// Of a path as in a table of --vary: "bodies[cloth].material.bending", "effects.drag.density",
/// "obstacles[0].friction". Empty for what no registry describes. Throws InputError: there is no
/// such body, effect, obstacle or parameter, or it is no number.
std::optional<SceneParameter> scene_parameter(const SceneSpec& scene, const std::string& path);

}  // namespace pliant
