#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

/// Knows where tf frames are.
class FrameTransformer {
 public:
  /// `target`: the frame that positions are wanted in.
  explicit FrameTransformer(std::string target);
  /// Knows what hear() is given, and listens to nobody: needs no master.
  static std::unique_ptr<FrameTransformer> without_listener(std::string target);
  void hear(const geometry_msgs::TransformStamped& transform, bool is_static = false);

  const std::string& target() const { return target_; }
  /// Target frame from `frame`, at the latest time that tf knows. "" is the target itself. Waits up
  /// to a quarter of a second of wall time for a frame that is not known yet. Throws InputError
  /// with the nearest known frame, or one of `others`, which a caller knows besides.
  Eigen::Isometry3d from(const std::string& frame,
                         const std::vector<std::string>& others = {}) const;

  struct StampedPose {
    ros::Time stamp;  ///< 0 of a static transform
    Eigen::Isometry3d pose;
  };
  /// `parent` from `child` at the latest time that tf knows; empty while it knows none. Does not
  /// wait.
  std::optional<StampedPose> latest(const std::string& parent, const std::string& child) const;
  /// At a stamp; empty where tf does not know it then. Does not wait.
  std::optional<Eigen::Isometry3d> at(const std::string& parent, const std::string& child,
                                      const ros::Time& stamp) const;
  /// Why latest() is empty, with the nearest frame: "tf knows no frame 'x'".
  std::string why_not(const std::string& parent, const std::string& child) const;

 private:
  FrameTransformer(std::string target, bool listens);
  [[noreturn]] void refuse(const std::string& frame, const std::string& reason,
                           const std::vector<std::string>& others) const;
  std::vector<std::string> known_frames() const;

  std::string target_;
  tf2_ros::Buffer buffer_;
  std::unique_ptr<tf2_ros::TransformListener> listener_;  // has a thread of its own
};

}  // namespace pliant
