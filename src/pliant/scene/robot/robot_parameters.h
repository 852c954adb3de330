#pragma once

#include <string>
#include <vector>

#include "pliant/core/parameters.h"

namespace pliant {

/// A key whose value is no parameter: a name, a path, a list or a map.
struct KeyText {
  std::string name, format, meaning;
};

/// What a scene's `robot` has besides robot_keys() and its pose.
std::vector<ParameterSpec> robot_parameters();
const std::vector<KeyText>& robot_keys();

}  // namespace pliant
