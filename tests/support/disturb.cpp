#include "support/disturb.h"

#include "support/random.h"

namespace pliant {

void disturb(World& world, double displacement, double speed, std::uint64_t seed) {
  Random random(seed);
  Particles& particles = particles_of(world);
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    particles.x.col(i) += random.vector(displacement);
    particles.v.col(i) += random.vector(speed);
  }
}

}  // namespace pliant
