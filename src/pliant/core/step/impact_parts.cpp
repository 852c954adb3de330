#include "pliant/core/step/impact_parts.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/group.h"

namespace pliant {
namespace {

constexpr int kParts = 8;
// A step may be so many times as long as that before it.
constexpr double kGrowth = 2.001;
constexpr double kGravity = 9.81;  // [m/s²]

/// Whether something throws it back: its centre of mass gains velocity twice as fast as what falls.
bool is_pushed(const Particles& p) {
  double mass = 0.0;
  Eigen::Vector3d gained = Eigen::Vector3d::Zero();
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    mass += p.mass[i];
    gained += p.mass[i] * p.history.gained.col(i);
  }
  return gained.norm() > 2.0 * kGravity * p.history.dt * mass;
}

/// Whether it moves faster than what fell for a step.
bool is_fast(const Particles& p, double dt) {
  double mass = 0.0, squared = 0.0;
  for (int i = 0; i < p.size(); ++i) {
    if (p.is_fixed(i)) continue;
    mass += p.mass[i];
    squared += p.mass[i] * p.v.col(i).squaredNorm();
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

bool any_is_pushed(const Group& group) {
  return std::any_of(group.bodies().begin(), group.bodies().end(),
                     [](const Body* body) { return is_pushed(body->particles()); });
}

bool any_is_fast(const Group& group, double dt) {
  return std::any_of(group.bodies().begin(), group.bodies().end(),
                     [&](const Body* body) { return is_fast(body->particles(), dt); });
}

}  // namespace

int parts_after_impact(const Group& group, double dt) {
  if (!is_of_second_order(group)) return 1;
  // Nothing is known of the last step after an impact, nor before the first one.
  const MotionHistory& last = group.first().particles().history;
  if (last.moved.cols() == 0) return 1;
  // While a bounce lasts, its steps stay as short as they are.
  const double growth = last.dt > 0.0 && any_is_pushed(group) ? 1.001 : kGrowth;
  int parts = 1;
  while (parts < kParts && dt / parts > growth * last.dt) parts *= 2;
  return any_is_fast(group, dt) ? parts : 1;
}

}  // namespace pliant
