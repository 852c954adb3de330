#include "pliant/effects/contact/surface_depth.h"

#include <fmt/format.h>

#include <algorithm>

namespace pliant {
namespace {

// Steps of a run that are all looked at, and after how many one is later.
constexpr std::uint64_t kFirst = 16, kEvery = 8;

}  // namespace

double SurfaceDepth::size(const Positions& x) const {
  Eigen::AlignedBox3d box;
  for (int p = 0; p < surface_->size(); ++p) box.extend(surface_->position(x, p));
  return box.sizes().maxCoeff();
}

double SurfaceDepth::depth(const Positions& x, const Obstacle& obstacle) const {
  const Eigen::Isometry3d shape_from_world = obstacle.pose_end.inverse();
  double deepest = 0.0;
  for (int p = 0; p < surface_->size(); ++p) {
    const Eigen::Vector3d point = shape_from_world * surface_->position(x, p);
    deepest = std::max(deepest, -obstacle.shape->distance(point));
  }
  return deepest;
}

void SurfaceDepth::look(const Particles& particles, const std::vector<Obstacle>& obstacles,
                        const std::vector<Contact>& contacts, StepReport& report) const {
  const bool is_due = report.step <= kFirst || report.step % kEvery == 0;
  if (surface_ == nullptr || !is_due) return;
  double deepest = 0.0;
  for (int o = 0; o < static_cast<int>(obstacles.size()); ++o) {
    const auto presses = [o](const Contact& c) { return c.obstacle == o && c.normal_force > 0.0; };
    if (std::none_of(contacts.begin(), contacts.end(), presses)) continue;
    deepest = std::max(deepest, depth(particles.x, obstacles[static_cast<std::size_t>(o)]));
  }
  if (deepest == 0.0 || !(deepest > kTold * size(particles.x))) return;
  report.warn(fmt::format(
      "surface_sinks_in: between the points that touch, the surface is about {:.1g} mm deep in an "
      "obstacle: give the body's geometry a smaller `contact_spacing`, or take more iterations",
      1e3 * deepest));
}

}  // namespace pliant
