#pragma once

#include <limits>

namespace pliant {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

}  // namespace pliant
