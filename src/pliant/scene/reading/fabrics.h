#pragma once

#include <string>
#include <vector>

#include "pliant/core/parameters.h"

namespace pliant {

/// A fabric of config/fabrics.yaml, which the program holds.
struct Fabric {
  std::string name;
  std::string description;   ///< one line
  std::string source;        ///< where the figures are from
  ParameterText parameters;  ///< of the model `cloth`
};

/// In the file's order. Throws InputError when the file that was built in is not right.
const std::vector<Fabric>& fabrics();
/// Throws InputError with the names and the nearest one.
const Fabric& find_fabric(const std::string& name);

/// The text of config/fabrics.yaml.
extern const char* const kFabricsText;

}  // namespace pliant
