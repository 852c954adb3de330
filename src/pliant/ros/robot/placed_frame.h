#pragma once

#include <Eigen/Geometry>
#include <string>

namespace pliant {

/// A tf frame and where it is in the node's frame.
struct PlacedFrame {
  std::string name;
  Eigen::Isometry3d pose;
};

}  // namespace pliant
