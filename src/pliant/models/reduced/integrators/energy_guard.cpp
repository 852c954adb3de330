#include "pliant/models/reduced/integrators/energy_guard.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Of the kinetic energy in one step, so that no motion is changed by a jerk.
constexpr double kMostTaken = 0.02;
constexpr double kSettled = 0.1;  // of what is allowed: there it lets go
// What is left of the sum after a step whose beginning others changed, and by how much of the
// energy that must be.
constexpr double kRemembered = 0.9;
constexpr double kChanged = 1e-9;

}  // namespace

void EnergyGuard::reset() {
  surplus_ = after_ = 0.0;
  is_taking_ = false;
}

double EnergyGuard::take(const EnergyChange& step, double kinetic) {
  if (std::abs(step.before - after_) > kChanged * step.before) surplus_ *= kRemembered;
  after_ = step.after;
  surplus_ += step.after - step.before - step.work + step.dissipated;
  // What damping takes away takes the past's errors along.
  if (step.dissipated > 0.0) surplus_ *= std::max(0.0, 1.0 - step.dissipated / step.after);
  const double allowed = share_ * step.after;
  if (!is_taking_ && std::abs(surplus_) <= allowed) return 0.0;
  const double taken = std::clamp(surplus_, -kMostTaken * kinetic, kMostTaken * kinetic);
  surplus_ -= taken;
  after_ -= taken;
  is_taking_ = std::abs(surplus_) > kSettled * allowed;
  return taken;
}

void EnergyGuard::save(StateArchive& numbers) const {
  numbers.write(surplus_);
  numbers.write(after_);
  numbers.write(is_taking_ ? 1.0 : 0.0);
}

void EnergyGuard::load(StateArchive& numbers) {
  surplus_ = numbers.read();
  after_ = numbers.read();
  is_taking_ = numbers.read() != 0.0;
}

}  // namespace pliant
