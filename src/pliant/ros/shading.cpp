#include "pliant/ros/shading.h"

#include <cmath>

namespace pliant {
namespace {

constexpr float kAmbient = 0.35f;
constexpr float kDiffuse = 0.65f;

/// From above and the side, so that both level and upright folds show.
float cosine_to_light(const Eigen::Vector3d& normal) {
  static const Eigen::Vector3d kLight = Eigen::Vector3d(0.4, -0.3, 0.87).normalized();
  return static_cast<float>(kLight.dot(normal));
}

}  // namespace

float sheet_brightness(const Eigen::Vector3d& normal) {
  return kAmbient + kDiffuse * std::abs(cosine_to_light(normal));
}

float solid_brightness(const Eigen::Vector3d& normal) {
  return kAmbient + kDiffuse * (0.5f + 0.5f * cosine_to_light(normal));
}

}  // namespace pliant
