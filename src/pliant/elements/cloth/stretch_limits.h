#pragma once

#include <string>

namespace pliant {

/// Stretches that cost no energy.
struct StretchLimits {
  double min = 0.9;  ///< in (0, 1]
  double max = 1.1;  ///< in [1, infinity]
};

/// Throws InputError, beginning with `name`, for limits out of their range.
void check(const std::string& name, const StretchLimits& limits);

}  // namespace pliant
