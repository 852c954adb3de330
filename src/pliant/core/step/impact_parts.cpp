#include "pliant/core/step/impact_parts.h"

#include <algorithm>

#include "pliant/core/body.h"
#include "pliant/core/group.h"

namespace pliant {
namespace {

constexpr int kParts = 4;
// A step may be so many times as long as that before it.
constexpr double kGrowth = 2.001;
constexpr double kGravity = 9.81;  // [m/s²]

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

bool looks_back(const Group& group) {
  const IntegratedStep* integrated = group.integrated();
  if (integrated == nullptr || !integrated->integration().ends_with_solver()) return false;
  const auto& bodies = group.bodies();
  return group.solver().takes_time_integration() &&
         std::none_of(bodies.begin(), bodies.end(),
                      [](const Body* body) { return body->model->needs_first_order(); });
}

}  // namespace

int parts_after_impact(const Group& group, double dt) {
  if (!looks_back(group)) return 1;
  // Nothing is known of the last step after an impact, nor before the first one.
  const MotionHistory& last = group.first().particles().history;
  if (last.moved.cols() == 0) return 1;
  int parts = 1;
  while (parts < kParts && dt / parts > kGrowth * last.dt) parts *= 2;
  const auto moves = [&](const Body* body) { return is_fast(body->particles(), dt); };
  return std::any_of(group.bodies().begin(), group.bodies().end(), moves) ? parts : 1;
}

}  // namespace pliant
