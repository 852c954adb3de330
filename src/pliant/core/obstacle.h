#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/geometry/distance/shape.h"

namespace pliant {

/// Something that is not deformed: a shape, and its motion over the running step.
struct Obstacle {
  std::string name;
  std::shared_ptr<const Shape> shape;
  Eigen::Isometry3d pose_start = Eigen::Isometry3d::Identity();  ///< world from shape
  Eigen::Isometry3d pose_end = Eigen::Isometry3d::Identity();
  std::optional<double> friction;     ///< Coulomb coefficient; without it the effect's
  std::optional<double> temperature;  ///< of its surface [K]; without it, it passes no heat
  bool liquid = false;                ///< bodies pass into it, and cloth in it gets wet
  std::string link;                   ///< robot link it belongs to; "" for a scene's own obstacle
  Eigen::Isometry3d link_from_shape = Eigen::Isometry3d::Identity();
  Eigen::Vector4f color = Eigen::Vector4f(0.6f, 0.6f, 0.6f, 1.0f);
};

/// Force and torque of bodies on one obstacle during the last step, in world axes.
struct Reaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  Eigen::Vector3d torque =
      Eigen::Vector3d::Zero();  ///< about the origin of the obstacle's pose_end [N m]
};

/// Moves obstacles. A robot is one.
class ObstacleDriver {
 public:
  virtual ~ObstacleDriver() = default;
  /// Sets pose_end of the obstacles it moves to their pose at `time` [s].
  virtual void drive(double time, std::vector<Obstacle>& obstacles) = 0;
};

}  // namespace pliant
