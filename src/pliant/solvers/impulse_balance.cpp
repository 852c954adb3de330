#include "pliant/solvers/impulse_balance.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/columns.h"

namespace pliant {
namespace {

constexpr int kComponentGrain = 64;
// Rounds of finish(): turns and friction are not linear. Within a few rounds the last digits come, or
// what contacts leave no place for stays out of balance; large turns of soft bodies take more.
constexpr int kRounds = 24, kSureRounds = 4;
constexpr double kProgress = 0.7;

}  // namespace

void ImpulseBalance::prepare(const ProjectiveSystem& system, double dt) {
  dt_ = dt;
  components_ = find_components(system);
  has_outer_ = !components_.outer_sets.empty();
  modes_.assign(static_cast<std::size_t>(components_.count()), Mode());
  large_.clear();
  is_needed_ = false;
  for (int c = 0; c < components_.count(); ++c) {
    is_needed_ = is_needed_ || takes_part(c);
    if (takes_part(c) && components_.size(c) > kColumnGrain) large_.push_back(c);
  }
}

bool ImpulseBalance::is_possible(const ProjectiveSystem& system) const {
  return is_needed_ &&
         std::none_of(system.couplings.begin(), system.couplings.end(),
                      [](const Coupling* coupling) { return coupling->pushes_from_outside(); });
}

void ImpulseBalance::turn_prediction(ProjectiveSystem& system) {
  if (!is_needed_) return;
  for (const int c : large_) turn_prediction(system.particles, c);
  parallel_for(0, components_.count(), kComponentGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) {
      if (takes_part(c) && components_.size(c) <= kColumnGrain) {
        turn_prediction(system.particles, c);
      }
    }
  });
}

void ImpulseBalance::turn_prediction(Particles& p, int component) const {
  const auto c = static_cast<std::size_t>(component);
  const int* members = components_.members.data();
  const int begin = components_.begins[c], end = components_.begins[c + 1];
  const Eigen::Vector3d origin = p.x_start.col(members[begin]);
  const rigid::Moments sums = parallel_reduce(
      begin, end, kColumnGrain,
      [&](int from, int to) {
        rigid::Moments part;
        for (int k = from; k < to; ++k) {
          const int i = members[k];
          const double m = p.mass[i];
          const Eigen::Vector3d q = p.x_start.col(i) - origin, y = p.x.col(i) - origin;
          part.mass += m;
          part.start += m * q;
          part.predicted += m * y;
          part.second += (m * q) * q.transpose();
          part.mixed += (m * y) * q.transpose();
        }
        return part;
      },
      [](const rigid::Moments& a, const rigid::Moments& b) { return a + b; });
  const rigid::Turn turn = rigid::turn_of(sums);
  if (!turn.any) return;
  parallel_for(begin, end, kColumnGrain, [&](int from, int to) {
    for (int k = from; k < to; ++k) {
      const int i = members[k];
      p.x.col(i) += turn.way(p.x_start.col(i) - origin, p.x.col(i) - origin);
    }
  });
}

void ImpulseBalance::correct(ProjectiveSystem& system, const Eigen::VectorXd& mobility) {
  if (!is_possible(system)) return;
  collect(system);
  find_touches(system, mobility);
  solve_islands(false);
  move(system, mobility);
  give_back(system);
}

void ImpulseBalance::finish(ProjectiveSystem& system, const Eigen::VectorXd& mobility) {
  if (!is_possible(system)) return;
  double last = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    collect(system);
    find_touches(system, mobility);
    const double now = worst();
    if (now <= rigid::kRoundOff && contacts_hold()) return;
    if (round >= kSureRounds && now > kProgress * last) return;
    last = now;
    solve_islands(true);
    move(system, mobility);
    give_back(system);
  }
}

double ImpulseBalance::imbalance(const ProjectiveSystem& system) {
  if (!is_needed_) return 0.0;
  collect(system);
  find_touches(system, system.particles.inverse_mass);
  return worst();
}

void ImpulseBalance::collect(const ProjectiveSystem& system) {
  find_forces(system);
  const int count = components_.count();
  for (const int c : large_) find_mode(system, c);
  parallel_for(0, count, kComponentGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) {
      if (takes_part(c) && components_.size(c) <= kColumnGrain) find_mode(system, c);
    }
  });
}

void ImpulseBalance::find_forces(const ProjectiveSystem& system) {
  const Particles& particles = system.particles;
  rows_.clear();
  has_other_forces_ = false;
  const auto others = [&]() -> Forces& {
    if (!has_other_forces_) parallel_zero(particles.size(), other_forces_);
    has_other_forces_ = true;
    return other_forces_;
  };
  for (const Coupling* coupling : system.couplings) {
    const std::size_t before = rows_.all().size();
    coupling->add_contacts(particles.x, rows_);
    if (rows_.all().size() == before && coupling->active() > 0) coupling->add_forces(others());
  }
  for (const std::size_t set : components_.outer_sets) {
    system.elements[set]->add_forces(particles.x, others());
  }
}

void ImpulseBalance::find_mode(const ProjectiveSystem& system, int component) {
  const Particles& p = system.particles;
  const auto c = static_cast<std::size_t>(component);
  const int* members = components_.members.data();
  const int begin = components_.begins[c], end = components_.begins[c + 1];
  const Eigen::Vector3d origin = p.x.col(members[begin]);
  const bool is_held = has_outer_;
  const double h = dt_;
  const rigid::Sums sums = parallel_reduce(
      begin, end, kColumnGrain,
      [&](int from, int to) {
        rigid::Sums part;
        for (int k = from; k < to; ++k) {
          const int i = members[k];
          const Eigen::Vector3d q = p.x.col(i) - origin;
          const double m = p.mass[i];
          // M (y − x)/h² without the external forces, which are added as they are.
          const Eigen::Vector3d inertial =
              m / h * ((p.x_start.col(i) - p.x.col(i)) / h + p.v_start.col(i));
          Eigen::Vector3d g = inertial + system.external_forces.col(i);
          part.size += inertial.norm() + system.external_forces.col(i).norm();
          if (has_other_forces_) {
            g += other_forces_.col(i);
            part.size += other_forces_.col(i).norm();
          }
          part.mass += m;
          part.first += m * q;
          part.second += (m * q) * q.transpose();
          part.force += g;
          part.torque += q.cross(g);
          if (!is_held || components_.outer_stiffness[i] == 0.0) continue;
          const double e = components_.outer_stiffness[i];
          part.held += e;
          part.held_first += e * q;
          part.held_second += (e * q) * q.transpose();
        }
        return part;
      },
      [](const rigid::Sums& a, const rigid::Sums& b) { return a + b; });

  Mode& mode = modes_[c];
  static_cast<rigid::Mode&>(mode) = rigid::mode_of(sums, origin, 1.0 / (h * h));
  mode.balance = mode.unbalanced;
  mode.motion.setZero();
  mode.local.setZero();
}

bool ImpulseBalance::contacts_hold() const {
  for (std::size_t r = 0; r < touches_.size(); ++r) {
    if (touches_[r].compliance > 0.0 && rows_.all()[r].gap < -rows_.all()[r].rest) return false;
  }
  return true;
}

double ImpulseBalance::worst() const {
  double worst = 0.0;
  for (int c = 0; c < components_.count(); ++c) {
    if (!takes_part(c)) continue;
    const Mode& mode = modes_[static_cast<std::size_t>(c)];
    if (mode.size > 0.0) worst = std::max(worst, mode.balance.cwiseAbs().maxCoeff() / mode.size);
  }
  return worst;
}

void ImpulseBalance::give_way(const Particles& p, const Eigen::VectorXd& mobility) {
  local_.clear();
  for (std::size_t r = 0; r < touches_.size(); ++r) {
    const Touch& touch = touches_[r];
    if (touch.compliance == 0.0) continue;
    const ContactRow& row = rows_.all()[r];
    const Eigen::Vector3d change = row.force() - touch.force;
    if (change.isZero(0.0)) continue;
    for (std::size_t k = 0; k < row.count; ++k) {
      const int i = row.particles[k];
      const Eigen::Vector3d way = row.weights[k] * mobility[i] * change;
      local_.emplace_back(i, way);
      const int c = components_.of[static_cast<std::size_t>(i)];
      if (!takes_part(c)) continue;
      Mode& mode = modes_[static_cast<std::size_t>(c)];
      const double rate = p.mass[i] / (dt_ * dt_);
      const Eigen::Vector3d q = (p.x.col(i) - mode.center) / mode.radius;
      mode.local.head<3>() += rate * way;
      mode.local.tail<3>() += rate * q.cross(way);
    }
  }
}

void ImpulseBalance::move(ProjectiveSystem& system, const Eigen::VectorXd& mobility) {
  Particles& p = system.particles;
  // Contacts give way by what their forces changed. That holds a momentum that no force gave it,
  // which the component's motion takes away again.
  give_way(p, mobility);
  const auto move_members = [&](const Mode& mode, int from, int to) {
    const Eigen::Vector3d shift = mode.motion.head<3>();
    const Eigen::Vector3d turn = mode.motion.tail<3>() / mode.radius;
    const Eigen::Matrix3d change = rigid::change_of(turn);
    for (int m = from; m < to; ++m) {
      const int i = components_.members[static_cast<std::size_t>(m)];
      p.x.col(i) += shift + change * (p.x.col(i) - mode.center);
    }
  };
  parallel_for(0, components_.count(), kComponentGrain, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) {
      if (!takes_part(c)) continue;
      const auto at = static_cast<std::size_t>(c);
      Mode& mode = modes_[at];
      mode.motion -= mode.holding(mode.local);
      if (components_.size(c) > kColumnGrain) continue;
      move_members(mode, components_.begins[at], components_.begins[at + 1]);
    }
  });
  for (const int c : large_) {
    const auto at = static_cast<std::size_t>(c);
    parallel_for(components_.begins[at], components_.begins[at + 1], kColumnGrain,
                 [&](int from, int to) { move_members(modes_[at], from, to); });
  }
  for (const auto& [particle, way] : local_) p.x.col(particle) += way;
}

void ImpulseBalance::give_back(ProjectiveSystem& system) {
  for (Coupling* coupling : system.couplings) coupling->take_contacts(rows_);
}

}  // namespace pliant
