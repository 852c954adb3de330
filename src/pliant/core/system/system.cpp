#include "pliant/core/system/system.h"

#include <utility>

namespace pliant {

void System::undo_step() {
  particles.x.swap(particles.x_start);
  particles.v.swap(particles.v_start);
  particles.v_start.swap(particles.v_before);
  std::swap(particles.history, particles.history_before);
  particles.inertia.is_used = false;
}

double ProjectiveSystem::elastic_energy() const {
  double sum = 0.0;
  for (const auto& set : elements) {
    if (!set->is_viscous()) sum += set->energy(particles.x);
  }
  return sum;
}

double ProjectiveSystem::viscous_energy() const {
  double sum = 0.0;
  for (const auto& set : elements) {
    if (set->is_viscous()) sum += set->energy(particles.x);
  }
  return sum;
}

void ProjectiveSystem::reset() {
  for (const auto& set : elements) set->reset();
}

void ProjectiveSystem::save(StateArchive& numbers) const {
  for (const auto& set : elements) set->save(numbers);
}

void ProjectiveSystem::load(StateArchive& numbers) {
  for (const auto& set : elements) set->load(numbers);
}

}  // namespace pliant
