#pragma once

#include "support/random.h"
#include "support/worlds.h"

namespace pliant {

/// Random displacements [m] and velocities [m/s] of the particles that are not fixed.
inline void disturb(World& world, double displacement, double speed, std::uint64_t seed = 1) {
  Random random(seed);
  Particles& particles = particles_of(world);
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    particles.x.col(i) += random.vector(displacement);
    particles.v.col(i) += random.vector(speed);
  }
}

}  // namespace pliant
