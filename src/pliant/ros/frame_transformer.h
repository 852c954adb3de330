#pragma once

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace pliant {

/// Knows where tf frames are.
class FrameTransformer {
 public:
  /// `target`: the frame that positions are wanted in. `links`: of robots, whose frames others say.
  FrameTransformer(std::string target, std::vector<std::string> links);

  /// Target frame from `frame`, at the latest time that tf knows. "" is the target itself. Waits up
  /// to a quarter of a second of wall time for a frame that is not known yet. Throws InputError
  /// with the nearest known frame.
  Eigen::Isometry3d from(const std::string& frame) const;

 private:
  [[noreturn]] void refuse(const std::string& frame, const std::string& reason) const;

  std::string target_;
  std::vector<std::string> links_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;  // has a thread of its own
};

}  // namespace pliant
