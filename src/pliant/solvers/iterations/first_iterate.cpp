#include "pliant/solvers/iterations/first_iterate.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {
constexpr int kGrain = 1024;
// An acceleration from two velocities is known no better: in free fall the prediction is exact.
constexpr double kRoundOff = 1e-9;
}  // namespace

void start_near_solution(ProjectiveSystem& system, double dt) {
  // A body that nothing can hold falls: from any other start few iterations would slow it down.
  const auto is_idle = [](const Constraint* constraint) { return constraint->is_idle(); };
  if (std::all_of(system.constraints.begin(), system.constraints.end(), is_idle)) return;
  Particles& p = system.particles;
  parallel_for(0, p.size(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      if (p.is_fixed(i)) continue;
      const Eigen::Vector3d external = p.inverse_mass[i] * system.external_forces.col(i);
      const double squared = external.squaredNorm();
      if (squared == 0.0) continue;
      const double along = (p.v_start.col(i) - p.v_before.col(i)).dot(external) / (dt * squared);
      if (along > 1.0 - kRoundOff) continue;
      p.x.col(i) -= (1.0 - std::max(along, 0.0)) * dt * dt * external;
    }
  });
}

}  // namespace pliant
