#pragma once

#include <functional>
#include <string>

#include "pliant/core/parameters.h"

namespace pliant {

/// A scalar of each particle that may be set while the simulation runs, such as `beta`.
struct SettableField {
  ParameterSpec spec;   ///< name, unit, range and meaning
  std::string why_not;  ///< not empty: why it may not be set, and what may instead
  std::function<double(int particle)> value;
  /// Takes effect with the next step.
  std::function<void(int particle, double value)> set;
};

}  // namespace pliant
