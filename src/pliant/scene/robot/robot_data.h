#pragma once

#include <Eigen/Geometry>
#include <kdl/segment.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "pliant/scene/robot/robot.h"

namespace pliant {

/// A robot as its forward kinematics walks it. Names have the prefix.
struct Robot::Data {
  struct Link {
    int parent = -1;  ///< index of a link; -1 for the root
    int joint = -1;   ///< index of the joint that moves it; -1 when it is fixed to its parent
    int free = -1;    ///< index of the free joint that it hangs on; -1 without
    double multiplier = 1.0;  ///< the segment's angle or travel is multiplier * position + offset
    double offset = 0.0;
    KDL::Segment segment;  ///< from the parent link's frame to this one's
  };
  struct Collision {
    std::string name;  ///< "LINK/collision I" or "LINK/visual I"
    std::string note;  ///< of a mesh: what collider it became, and why; else ""
    int link = 0;
    std::shared_ptr<const Shape> shape;
    Eigen::Isometry3d link_from_shape = Eigen::Isometry3d::Identity();
    Eigen::Vector4f color = Obstacle().color;
  };
  /// A joint without a position of its own.
  struct PassiveJoint {
    std::string why;    ///< "is fixed", "mimics 'a'", "is floating"
    int mimicked = -1;  ///< index of the joint that it follows in the end
  };

  std::string name, prefix;
  JointLimitRule limit_rule = JointLimitRule::kRefuse;
  std::vector<std::string> warnings;
  std::vector<std::string> joint_names;
  std::vector<Limits> limits;
  std::vector<double> efforts;     ///< of each joint, Robot::effort()
  std::vector<bool> is_prismatic;  ///< of each joint
  std::map<std::string, PassiveJoint> passive_joints;
  std::vector<FreeJoint> free_joints;
  std::vector<std::string> link_names;  ///< parents first
  std::vector<Link> links;
  std::vector<Collision> collisions;
  std::vector<double> initial;
  Placement placement;
  mutable std::mutex segments_in_use;  ///< KDL caches the last pose in each segment
};

}  // namespace pliant
