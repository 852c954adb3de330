#pragma once

#include <vector>

#include "pliant/core/parameters.h"

namespace pliant {

/// What an item of a scene's `obstacles` has besides its name, shape, size, pose and color.
std::vector<ParameterSpec> obstacle_parameters();

}  // namespace pliant
