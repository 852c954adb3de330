#pragma once

#include <string>
#include <vector>

#include "pliant/scene/scene.h"

namespace pliant {

/// Makes the robots of a scene, adds their links' shapes to `world` as obstacles and, unless the
/// caller does so, their drivers. Throws InputError "FILE:LINE: ...".
std::vector<SceneRobot> add_robots(const SceneSpec& spec, const SceneOverrides& overrides,
                                   World& world);

/// What is legal in the scene's robots but surely not meant.
std::vector<std::string> robot_warnings(const LoadedScene& scene, const SceneOverrides& overrides);

}  // namespace pliant
