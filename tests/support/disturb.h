#pragma once

#include "support/worlds/worlds.h"

namespace pliant {

/// Random displacements [m] and velocities [m/s] of the particles that are not fixed.
void disturb(World& world, double displacement, double speed, std::uint64_t seed = 1);

}  // namespace pliant
