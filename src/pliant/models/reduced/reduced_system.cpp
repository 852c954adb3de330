#include "pliant/models/reduced/reduced_system.h"

namespace pliant {

ReducedSystem::ReducedSystem(QuarticPotential reduced_potential, RayleighDamping rayleigh)
    : potential(std::move(reduced_potential)), damping(rayleigh) {
  q = p = force = Eigen::VectorXd::Zero(potential.rank());
}

Eigen::VectorXd ReducedSystem::damping_rates() const {
  return (damping.mass + damping.stiffness * potential.lambda().array()).matrix();
}

double ReducedSystem::linear_energy(int first) const {
  const auto count = q.size() - first;
  return 0.5 * (p.tail(count).squaredNorm() +
                potential.lambda().tail(count).dot(q.tail(count).cwiseAbs2()));
}

}  // namespace pliant
