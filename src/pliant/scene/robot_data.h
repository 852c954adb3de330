#pragma once

#include <Eigen/Geometry>
#include <kdl/segment.hpp>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "pliant/scene/robot.h"

namespace pliant {

/// A robot as its forward kinematics walks it.
struct Robot::Data {
  struct Link {
    int parent = -1;  ///< index of a link; -1 for the root
    int joint = -1;   ///< index of the joint that moves it; -1 when it is fixed to its parent
    double multiplier = 1.0;  ///< the segment's angle or way is multiplier * position + offset
    double offset = 0.0;
    KDL::Segment segment;  ///< from the parent link's frame to this one's
  };
  struct Collision {
    std::string name;  ///< "LINK/collision I"
    int link = 0;
    std::shared_ptr<const Shape> shape;
    Eigen::Isometry3d link_from_shape = Eigen::Isometry3d::Identity();
  };

  std::string name;
  std::vector<std::string> joint_names;
  std::vector<Limits> limits;
  std::set<std::string> passive_joints;  ///< fixed or mimicking
  std::vector<std::string> link_names;   ///< parents first
  std::vector<Link> links;
  std::vector<Collision> collisions;
  std::vector<double> initial;
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  mutable std::mutex segments_in_use;  ///< KDL caches the last pose in each segment
};

}  // namespace pliant
