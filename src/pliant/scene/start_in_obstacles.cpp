#include "pliant/scene/start_in_obstacles.h"

#include <fmt/format.h>

#include <algorithm>

namespace pliant {
namespace {

// What lies on a surface may be this much of its own size within it.
constexpr double kTouching = 1e-3;

struct Depth {
  int count = 0;         // of the vertices within
  double deepest = 0.0;  // [m]
};

Depth depth_in(const Obstacle& obstacle, const Particles& particles, double tolerance) {
  const Eigen::Isometry3d shape_from_world = obstacle.pose_start.inverse();
  const Eigen::AlignedBox3d bounds = obstacle.shape->bounds();
  Depth depth;
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.is_fixed(i)) continue;
    const Eigen::Vector3d p = shape_from_world * particles.x.col(i);
    if (!bounds.contains(p)) continue;
    const double within = -obstacle.shape->distance(p);
    if (within <= tolerance) continue;
    ++depth.count;
    depth.deepest = std::max(depth.deepest, within);
  }
  return depth;
}

double size_of(const Positions& x) {
  return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

}  // namespace

std::vector<std::string> find_starts_in_obstacles(const World& world) {
  std::vector<std::string> warnings;
  for (const Body& body : world.bodies()) {
    const Particles& particles = body.particles();
    if (body.find_effect("contact") == nullptr || particles.size() == 0) continue;
    const double tolerance = kTouching * size_of(particles.x);
    for (const Obstacle& obstacle : world.obstacles()) {
      if (obstacle.liquid) continue;
      const Depth depth = depth_in(obstacle, particles, tolerance);
      if (depth.count == 0) continue;
      warnings.push_back(fmt::format(
          "body '{}' starts inside obstacle '{}': {} of its {} vertices are up to {:.3g} mm deep, "
          "and contact pushes them out as the scene begins; move one of the two",
          body.name, obstacle.name, depth.count, particles.size(), 1e3 * depth.deepest));
    }
  }
  return warnings;
}

}  // namespace pliant
