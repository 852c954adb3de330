#include "pliant/ros/markers/shading.h"

#include <cmath>

namespace pliant {
namespace {

constexpr float kAmbient = 0.35f;
constexpr float kDiffuse = 0.65f;

float cosine_to_light(const Eigen::Vector3d& normal) {
  return static_cast<float>(to_light().dot(normal));
}

}  // namespace

const Eigen::Vector3d& to_light() {
  // From above and the side, so that both level and upright folds show.
  static const Eigen::Vector3d kLight = Eigen::Vector3d(0.4, -0.3, 0.87).normalized();
  return kLight;
}

float sheet_brightness(const Eigen::Vector3d& normal) {
  return kAmbient + kDiffuse * std::abs(cosine_to_light(normal));
}

float solid_brightness(const Eigen::Vector3d& normal) {
  return kAmbient + kDiffuse * (0.5f + 0.5f * cosine_to_light(normal));
}

}  // namespace pliant
