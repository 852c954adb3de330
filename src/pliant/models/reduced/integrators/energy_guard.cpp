#include "pliant/models/reduced/integrators/energy_guard.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Of the kinetic energy in one step, so that no motion is changed by a jerk.
constexpr double kMostOfErrors = 0.2;
constexpr double kMostOfSurplus = 0.02;
constexpr double kBand = 3.0;     // of the surplus, in shares
constexpr double kSettled = 0.1;  // of the errors, in shares

double clamp_to(double value, double bound) { return std::clamp(value, -bound, bound); }

}  // namespace

void EnergyGuard::reset() {
  gained_ = surplus_ = 0.0;
  is_taking_ = false;
}

double EnergyGuard::take(const EnergyChange& step, double kinetic) {
  gained_ += step.error;
  surplus_ += step.after - step.before - step.work + step.dissipated;
  // What damping takes away takes the past's errors along.
  if (step.dissipated > 0.0) {
    const double left = std::max(0.0, 1.0 - step.dissipated / step.after);
    gained_ *= left;
    surplus_ *= left;
  }
  double taken = 0.0;
  const double allowed = share_ * step.after;
  if (is_taking_ || std::abs(gained_) > allowed) {
    // An error that the balance does not show was made good where the number of parts changed.
    if (gained_ * surplus_ <= 0.0) gained_ = 0.0;
    taken = clamp_to(clamp_to(gained_, std::abs(surplus_)), kMostOfErrors * kinetic);
    gained_ -= taken;
    is_taking_ = std::abs(gained_) > kSettled * allowed;
  }
  surplus_ -= taken;
  const double over = std::abs(surplus_) - kBand * allowed;
  if (step.is_strained && over > 0.0) {
    const double more = std::copysign(std::min(over, kMostOfSurplus * kinetic), surplus_);
    surplus_ -= more;
    taken += more;
  }
  return taken;
}

void EnergyGuard::save(SavedNumbers& numbers) const {
  numbers.write(gained_);
  numbers.write(surplus_);
  numbers.write(is_taking_ ? 1.0 : 0.0);
}

void EnergyGuard::load(SavedNumbers& numbers) {
  gained_ = numbers.read();
  surplus_ = numbers.read();
  is_taking_ = numbers.read() != 0.0;
}

}  // namespace pliant
