#include "pliant/core/system.h"

namespace pliant {

double ProjectiveSystem::elastic_energy() const {
  double sum = 0.0;
  for (const auto& set : elements) sum += set->energy(particles.x);
  return sum;
}

}  // namespace pliant
