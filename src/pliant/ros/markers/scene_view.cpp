#include "pliant/ros/markers/scene_view.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/math/error.h"
#include "pliant/scene/scene.h"

namespace pliant {
namespace {

/// rviz's cameras see 45 degrees from top to bottom.
constexpr double kHalfFieldOfView = 0.125 * M_PI;

/// A ball around a box is larger than what it shows, which mostly is flat: this much of it fills
/// the height of the picture.
constexpr double kShownShare = 0.8;

Eigen::AlignedBox3d bounds_of(const Obstacle& obstacle) {
  const Eigen::AlignedBox3d local = obstacle.shape->bounds();
  Eigen::AlignedBox3d bounds;
  // An infinite side times a zero of the rotation is no number.
  if (!local.sizes().allFinite()) return bounds;
  for (int corner = 0; corner < 8; ++corner) {
    bounds.extend(obstacle.pose_start *
                  local.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return bounds;
}

}  // namespace

Eigen::AlignedBox3d scene_bounds(const LoadedScene& scene) {
  Eigen::AlignedBox3d bounds;
  for (const Body& body : scene.world->bodies()) {
    const Eigen::Matrix3Xd& positions = body.particles().x;
    for (int i = 0; i < positions.cols(); ++i) bounds.extend(Eigen::Vector3d(positions.col(i)));
  }
  std::vector<Eigen::AlignedBox3d> others;
  for (const Obstacle& obstacle : scene.world->obstacles()) {
    const Eigen::AlignedBox3d box = bounds_of(obstacle);
    if (box.isEmpty()) continue;
    if (obstacle.link.empty()) {
      others.push_back(box);
    } else {
      bounds.extend(box);
    }
  }
  const double size = bounds.isEmpty() ? INFINITY : bounds.sizes().norm();
  for (const Eigen::AlignedBox3d& box : others) {
    if (box.sizes().norm() <= kLargestObstacle * size) bounds.extend(box);
  }
  const Eigen::AlignedBox3d cube(Eigen::Vector3d::Constant(-0.5), Eigen::Vector3d::Constant(0.5));
  return bounds.isEmpty() ? cube : bounds;
}

std::string framed_configuration(const std::string& configuration,
                                 const Eigen::AlignedBox3d& bounds) {
  try {
    YAML::Node root = YAML::Load(configuration);
    YAML::Node view = root["Visualization Manager"]["Views"]["Current"];
    if (!view["Distance"] || !view["Focal Point"]) {
      throw InputError("the configuration of rviz has no orbiting view to move");
    }
    const double radius = 0.5 * bounds.sizes().norm();
    view["Distance"] = kShownShare * radius / std::sin(kHalfFieldOfView);
    const Eigen::Vector3d centre = bounds.center();
    view["Focal Point"]["X"] = centre.x();
    view["Focal Point"]["Y"] = centre.y();
    view["Focal Point"]["Z"] = centre.z();
    return YAML::Dump(root) + "\n";
  } catch (const YAML::Exception& error) {
    throw InputError(std::string("the configuration of rviz: ") + error.what());
  }
}

}  // namespace pliant
