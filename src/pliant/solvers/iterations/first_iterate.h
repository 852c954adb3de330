#pragma once

#include "pliant/core/system/system.h"

namespace pliant {

/// Moves the first iterate from the prediction to where particles come that accelerate as they did
/// in the last step: what rests stays where it is however few the iterations, what falls goes on
/// falling (Chen et al. 2024, "Vertex block descent", sec. 3.7). For bodies with constraints: where
/// nothing can hold the body up, too few iterations would gain energy by it.
void start_near_solution(ProjectiveSystem& system, double dt);

}  // namespace pliant
