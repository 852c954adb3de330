#include "pliant/solvers/time/bdf2.h"

#include "pliant/core/columns.h"

namespace pliant {
namespace {
// Beyond this ratio of steps the formula is not stable any more: 1 + sqrt(2), less a little.
constexpr double kMostRatio = 2.4;
}  // namespace

double Bdf2::begin_step(Particles& p, double dt) const {
  const MotionHistory& last = p.history_before;
  if (last.dt == 0.0 || last.moved.cols() != p.x.cols()) return 0.0;
  const double w = dt / last.dt;
  if (w > kMostRatio) return 0.0;
  InertialStart& start = p.inertia;
  start.is_used = true;
  start.share = w * w / (1.0 + 2.0 * w);
  start.step = dt * (1.0 + w) / (1.0 + 2.0 * w);
  start.whole = dt;
  start.x.resize(3, p.x.cols());
  start.v.resize(3, p.x.cols());
  for_each_column(p.x, [&](int i) {
    if (p.is_fixed(i)) {
      start.x.col(i) = p.x.col(i);
      start.v.col(i).setZero();
      return;
    }
    start.x.col(i) = p.x.col(i) + start.share * last.moved.col(i);
    start.v.col(i) = p.v.col(i) + start.share * last.gained.col(i);
  });
  return start.step;
}

TimeIntegrationRegistry::Entry bdf2_entry() {
  return {"bdf2",
          "second order, from two steps before; damps motion too quick for the step",
          {},
          {"cloth", "patch", "viscoelastic"},
          [](const Parameters&) { return std::make_unique<Bdf2>(); }};
}

}  // namespace pliant
