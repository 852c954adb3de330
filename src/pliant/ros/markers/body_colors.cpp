#include "pliant/ros/markers/body_colors.h"

#include <algorithm>
#include <array>

namespace pliant {
namespace {

// Unlike a body's usual blue and each other, also for those who do not see all colours (Okabe and
// Ito 2008).
const std::array<Eigen::Vector3f, 6> kColors = {
    Eigen::Vector3f(0.90f, 0.62f, 0.00f), Eigen::Vector3f(0.00f, 0.62f, 0.45f),
    Eigen::Vector3f(0.80f, 0.47f, 0.65f), Eigen::Vector3f(0.84f, 0.37f, 0.00f),
    Eigen::Vector3f(0.94f, 0.89f, 0.26f), Eigen::Vector3f(0.34f, 0.71f, 0.91f)};

}  // namespace

void color_apart(LoadedScene& scene) {
  const std::vector<BodySpec>& specs = scene.spec.bodies;
  std::size_t next = 0;
  for (std::size_t b = 1; b < scene.world->bodies().size(); ++b) {
    Body& body = scene.world->bodies()[b];
    // One that others joined has another name, and colours of its own.
    const bool is_open = std::any_of(specs.begin(), specs.end(), [&](const BodySpec& spec) {
      return spec.name == body.name && !spec.color;
    });
    if (is_open) body.model->color = kColors[next++ % kColors.size()];
  }
}

}  // namespace pliant
