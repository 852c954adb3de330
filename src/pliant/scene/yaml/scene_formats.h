#pragma once

#include <string>
#include <vector>

#include "pliant/scene/robot/robot_parameters.h"

namespace pliant {

/// A format of a scene's files that no registry holds, for `pliant list` and the reference. Its
/// parameters are those that its reader checks.
struct SceneFormat {
  std::string title, description;
  std::vector<KeyText> keys;
  std::vector<ParameterSpec> parameters;
  std::string example = {};  ///< YAML
};

/// The ways to say which vertices of a body are meant.
std::vector<SceneFormat> region_formats();
/// The file that `robot.keyframes` names, and its items.
std::vector<SceneFormat> keyframe_formats();

}  // namespace pliant
