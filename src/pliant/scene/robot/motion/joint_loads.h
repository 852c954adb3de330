#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <vector>

#include "pliant/core/obstacle.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// What bodies did to a joint in a step.
struct JointLoad {
  double force = 0.0;  ///< of bodies on the links that it moves, along its position [N] or [N m]
  /// How far it can still go against that, where bodies have hardly room between links: below 0,
  /// how far it has to go back [m] or [rad].
  double room = std::numeric_limits<double>::infinity();
  bool is_crushed = false;  ///< so far that the step should not end there
};

/// Finds the loads of a robot's joints from reactions on its links' shapes.
class JointLoads {
 public:
  explicit JointLoads(const Robot& robot) : robot_(robot) {}

  /// One for each of Robot::joint_names(). `poses`: world from each link; `link_of_obstacle`: -1
  /// for what is no link.
  const std::vector<JointLoad>& find(const std::vector<Eigen::Isometry3d>& poses,
                                     const std::vector<int>& link_of_obstacle,
                                     const std::vector<Obstacle>& obstacles,
                                     const std::vector<Reaction>& reactions);

 private:
  /// How the points of a link move with the joint that moves it from its parent.
  struct Motion {
    Eigen::Vector3d axis, origin;  // world axes, times the link's multiplier
    bool is_prismatic;
    Eigen::Vector3d velocity(const Eigen::Vector3d& at) const {
      return is_prismatic ? axis : Eigen::Vector3d(axis.cross(at - origin));
    }
  };
  Motion motion(std::size_t link, const std::vector<Eigen::Isometry3d>& poses) const;
  void add_forces(const std::vector<Eigen::Isometry3d>& poses);
  void add_overlap(const Overlap& overlap, int link, const std::vector<Eigen::Isometry3d>& poses);

  const Robot& robot_;
  std::vector<Eigen::Vector3d> forces_, torques_;  // on each link and those below, about the origin
  std::vector<JointLoad> loads_;
};

}  // namespace pliant
