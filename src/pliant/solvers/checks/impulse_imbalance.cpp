#include "pliant/solvers/checks/impulse_imbalance.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/solvers/components/components.h"

namespace pliant {
namespace {

constexpr int kGrain = 2048;  // particles of a task

}  // namespace

void ImpulseImbalance::prepare(const ProjectiveSystem& system) {
  const Components all = find_components(system);
  members_.clear();
  begins_.assign(1, 0);
  for (int c = 0; c < all.count(); ++c) {
    const auto k = static_cast<std::size_t>(c);
    if (all.held[k] || all.begins[k + 1] - all.begins[k] == 1) continue;
    members_.insert(members_.end(), all.members.begin() + all.begins[k],
                    all.members.begin() + all.begins[k + 1]);
    begins_.push_back(static_cast<int>(members_.size()));
  }
}

ImpulseImbalance::Sums ImpulseImbalance::joined(const Sums& a, const Sums& b) {
  return {a.impulse + b.impulse, a.twist + b.twist, a.impulse_size + b.impulse_size,
          a.twist_size + b.twist_size};
}

double ImpulseImbalance::find(const ProjectiveSystem& system, double dt) {
  contact_.setZero(3, system.particles.size());
  for (const Constraint* constraint : system.constraints) constraint->add_forces(contact_);
  twisting_.resize(3, 0);
  for (const auto& set : system.elements) {
    if (!set->has_torque()) continue;
    if (twisting_.cols() == 0) twisting_.setZero(3, system.particles.size());
    set->add_forces(system.particles.x, twisting_);
  }
  double worst = 0.0;
  for (std::size_t c = 0; c + 1 < begins_.size(); ++c) {
    worst = std::max(worst, find(system, dt, begins_[c], begins_[c + 1]));
  }
  return worst;
}

double ImpulseImbalance::find(const ProjectiveSystem& system, double dt, int begin, int end) const {
  const Particles& p = system.particles;
  const Eigen::Matrix3Xd& velocity = p.v_inertial();
  const auto member = [&](int k) { return members_[static_cast<std::size_t>(k)]; };
  struct Center {
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    double mass = 0.0;
  };
  const Center all = parallel_reduce(
      begin, end, kGrain,
      [&](int from, int to) {
        Center sum;
        for (int k = from; k < to; ++k) {
          sum.moment += p.mass[member(k)] * p.x.col(member(k));
          sum.mass += p.mass[member(k)];
        }
        return sum;
      },
      [](const Center& a, const Center& b) {
        return Center{a.moment + b.moment, a.mass + b.mass};
      });
  const Eigen::Vector3d center = all.moment / all.mass;
  const Sums sums = parallel_reduce(
      begin, end, kGrain,
      [&](int from, int to) {
        Sums sum;
        for (int k = from; k < to; ++k) {
          const int i = member(k);
          const Eigen::Vector3d gained = p.mass[i] * (p.v.col(i) - velocity.col(i));
          const Eigen::Vector3d external = dt * system.external_forces.col(i);
          const Eigen::Vector3d contact = dt * contact_.col(i);
          const Eigen::Vector3d missed = gained - external - contact;
          const Eigen::Vector3d q = p.x.col(i) - center;
          const double size = gained.norm() + external.norm() + contact.norm();
          sum.impulse += missed;
          sum.twist += q.cross(missed);
          if (twisting_.cols() > 0) sum.twist -= dt * q.cross(Eigen::Vector3d(twisting_.col(i)));
          sum.impulse_size += size;
          sum.twist_size += q.norm() * size;
        }
        return sum;
      },
      joined);
  const double linear = sums.impulse_size > 0.0 ? sums.impulse.norm() / sums.impulse_size : 0.0;
  const double angular = sums.twist_size > 0.0 ? sums.twist.norm() / sums.twist_size : 0.0;
  return std::max(linear, angular);
}

}  // namespace pliant
