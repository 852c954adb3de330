#pragma once

#include <ros/time.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/ros/robot/even_motion.h"
#include "pliant/ros/robot/frame_transformer.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// The base of a robot, and its links behind floating and planar joints, from tf. Between two
/// transforms they move as EvenMotion says. What tf does not know stays where it is.
class TfPlacementSource final : public PlacementSource {
 public:
  /// `base_frame`: the frame that the base follows with its initial pose in it; empty: the base
  /// stays. `frames` outlives this.
  TfPlacementSource(const Robot& robot, const std::string& base_frame,
                    const FrameTransformer& frames);

  /// Whether there is nothing that it places.
  bool empty() const { return tracks_.empty(); }
  /// Transforms that tf does not know, as a user would read it; thread-safe.
  std::vector<std::string> missing() const;

  void place(double time, Robot::Placement& placement) override;

 private:
  struct Track {
    std::string what;           // "base_frame" or "floating joint 'f'"
    std::string parent, child;  // tf frames
    int free = -1;              // index of the free joint; -1: the base
    Eigen::Isometry3d child_from_link = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d start = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
    ros::Time stamp;
    bool is_known = false;
    EvenMotion motion;
  };
  void move(double time, Track& track, Eigen::Isometry3d& pose) const;

  const FrameTransformer& frames_;
  std::vector<Track> tracks_;
};

}  // namespace pliant
