#include "pliant/core/step/impact_substeps.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/group.h"

namespace pliant {
namespace {

constexpr int kSubsteps = 8;
// A step may be so many times as long as that before it.
constexpr double kGrowth = 2.001;
constexpr double kGravity = 9.81;  // [m/s²]

/// Whether something throws it back: its centre of mass gains velocity twice as fast as what falls.
/// Of an impact the history knows nothing, and `substep` [s] stands for the time that it took.
bool is_pushed(const Particles& p, double substep) {
  const double time = p.history.dt > 0.0 ? p.history.dt : substep;
  double mass = 0.0;
  Eigen::Vector3d gained = Eigen::Vector3d::Zero();
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    mass += p.mass[i];
    gained += p.mass[i] * (p.v.col(i) - p.v_start.col(i));
  }
  return gained.norm() > 2.0 * kGravity * time * mass;
}

/// Whether it moves, by these velocities, faster than what fell for a step.
bool is_fast(const Particles& p, const Eigen::Matrix3Xd& v, double dt) {
  double mass = 0.0, squared = 0.0;
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    mass += p.mass[i];
    squared += p.mass[i] * v.col(i).squaredNorm();
  }
  return squared > mass * (kGravity * dt) * (kGravity * dt);
}

bool is_of_second_order(const Group& group) {
  if (group.integrated() == nullptr) return false;
  const auto& bodies = group.bodies();
  return group.solver().takes_time_integration() &&
         std::none_of(bodies.begin(), bodies.end(),
                      [](const Body* body) { return body->model->needs_first_order(); });
}

bool any_is_pushed(const Group& group, double substep) {
  return std::any_of(group.bodies().begin(), group.bodies().end(),
                     [&](const Body* body) { return is_pushed(body->particles(), substep); });
}

bool any_is_fast(const Group& group, double dt) {
  return std::any_of(group.bodies().begin(), group.bodies().end(), [&](const Body* body) {
    return is_fast(body->particles(), body->particles().v, dt);
  });
}

bool any_was_fast(const Group& group, double dt) {
  return std::any_of(group.bodies().begin(), group.bodies().end(), [&](const Body* body) {
    return is_fast(body->particles(), body->particles().v_start, dt);
  });
}

}  // namespace

int substeps_after_impact(const Group& group, double dt) {
  if (!is_of_second_order(group)) return 1;
  // Nothing is known of the last step after an impact, nor before the first one.
  const MotionHistory& last = group.first().particles().history;
  if (last.moved.cols() == 0) return 1;
  // While a bounce lasts, its steps stay as short as they are, also where it turns back.
  const bool is_bouncing = any_is_pushed(group, dt / kSubsteps);
  if (!is_bouncing && !any_is_fast(group, dt)) return 1;
  const double growth = last.dt > 0.0 && is_bouncing ? 1.001 : kGrowth;
  int substeps = 1;
  while (substeps < kSubsteps && dt / substeps > growth * last.dt) substeps *= 2;
  return substeps;
}

int substeps_for_impact(const Group& group, double dt) {
  const bool has_hit = is_of_second_order(group) && group.integrated()->has_hit();
  return has_hit && any_was_fast(group, dt) ? kSubsteps : 1;
}

void take_back(Group& group) {
  for (Body* body : group.bodies()) {
    body->model->system().undo_step();
    for (const auto& effect : body->effects) effect->undo_step();
    body->report.forget_warnings(0);
    body->report.error.reset();
    body->report.impulse_imbalance.reset();
    body->report.energy_gained.reset();
    body->report.first_order = {};
    body->report.begin_substep();
  }
  Body& first = group.first();
  first.learned.rewind();
  group.solver().load(first.learned);
}

}  // namespace pliant
