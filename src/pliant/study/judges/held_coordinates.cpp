#include "pliant/study/judges/held_coordinates.h"

#include <algorithm>

namespace pliant {

double HeldCoordinates::energy(const Positions& x) const {
  double sum = 0.0;
  for (const Held& held : held_) sum += 0.5 * pull(held, x) * pull(held, x) / held.stiffness;
  return sum;
}

void HeldCoordinates::add_forces(const Positions& x, Forces& f) const {
  for (const Held& held : held_) f(held.axis, held.particle) += pull(held, x);
}

void HeldCoordinates::add_to_system(SystemMatrix& a) const {
  for (const Held& held : held_) a.add(held.particle, held.particle, held.stiffness);
}

void HeldCoordinates::add_stiffness(const Positions&, Definiteness, StiffnessMatrix& k) const {
  for (const Held& held : held_) {
    Eigen::Matrix3d block = Eigen::Matrix3d::Zero();
    block(held.axis, held.axis) = held.stiffness;
    k.add(held.particle, held.particle, block);
  }
}

void HeldCoordinates::reset_multipliers() {
  std::fill(multipliers_.begin(), multipliers_.end(), 0.0);
}

void HeldCoordinates::relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) {
  for (std::size_t n = 0; n < held_.size(); ++n) {
    const Held& held = held_[n];
    // Δλ (1 + h² w k) = f - λ
    const double mobility = dt * dt * inverse_mass[held.particle];
    const double delta = (pull(held, x) - multipliers_[n]) / (1.0 + mobility * held.stiffness);
    multipliers_[n] += delta;
    x(held.axis, held.particle) += mobility * delta;
  }
}

}  // namespace pliant
