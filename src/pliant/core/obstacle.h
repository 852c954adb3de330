#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/state_archive.h"
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

/// Where a body has no room: the point of it that is nearer to an obstacle than contact keeps it.
struct Overlap {
  double depth = 0.0;                                ///< by how much [m]; 0: all have room
  double offset = 0.0;                               ///< distance that contact keeps [m]
  Eigen::Vector3d at = Eigen::Vector3d::Zero();      ///< the point, world axes [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< away from the obstacle
};

/// Force and torque of bodies on one obstacle during the last step, in world axes.
struct Reaction {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N]
  Eigen::Vector3d torque =
      Eigen::Vector3d::Zero();  ///< about the origin of the obstacle's pose_end [N m]
  Overlap overlap;              ///< the deepest
};

/// Moves obstacles. A robot is one.
class ObstacleDriver {
 public:
  virtual ~ObstacleDriver() = default;
  /// Sets pose_end of the obstacles it moves to their pose at `time` [s].
  virtual void drive(double time, std::vector<Obstacle>& obstacles) = 0;
  /// Whether what bodies press on its obstacles with changes how it moves them: then the functions
  /// below are called.
  virtual bool yields() const { return false; }
  /// After a step to where drive() or the last call put the obstacles: what bodies did to them.
  /// Whether that was too much; pose_end is then where they can go instead, and the step is taken
  /// again. Never where that is the `last` try.
  virtual bool answer(const std::vector<Reaction>& /*reactions*/, bool /*last*/,
                      std::vector<Obstacle>& /*obstacles*/) {
    return false;
  }
  /// After a step that failed and was undone: whether the obstacles can stay nearer to where they
  /// were; pose_end is then there, and the step is taken again.
  virtual bool hold_back(std::vector<Obstacle>& /*obstacles*/) { return false; }
  /// What it keeps from one step to the next.
  virtual void save(StateArchive& /*numbers*/) const {}
  virtual void load(StateArchive& /*numbers*/) {}
};

}  // namespace pliant
