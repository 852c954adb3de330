#pragma once

#include <string>

#include "pliant/core/parameters.h"

namespace pliant {

/// The parameters of a solver that takes so many iterations on the GPU.
inline ParameterText on_gpu(int iterations, ParameterText others = {}) {
  others["iterations"] = std::to_string(iterations);
  others["backend"] = "cuda";
  return others;
}

}  // namespace pliant
