#pragma once

#include <ros/time.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/ros/robot/even_motion.h"
#include "pliant/ros/robot/frame_transformer.h"
#include "pliant/ros/robot/played_stamp.h"
#include "pliant/ros/robot/sender_lag.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// The base of a robot, and its links behind floating and planar joints, from tf. Where stamps are
/// simulated times they are where tf has them at the stamp that PlayedStamp says; else they move
/// between two transforms as EvenMotion says. What tf does not know stays where it is.
class TfPlacementSource final : public PlacementSource {
 public:
  /// `base_frame`: the frame that the base follows with its initial pose in it; empty: the base
  /// stays. `stamps_are_simulated`: senders know the simulated time, since this node publishes
  /// /clock. `frames` outlives this.
  TfPlacementSource(const Robot& robot, const std::string& base_frame, bool stamps_are_simulated,
                    const FrameTransformer& frames);

  /// Whether there is nothing that it places.
  bool empty() const { return tracks_.empty(); }
  /// Transforms that tf does not know, as a user would read it; thread-safe.
  std::vector<std::string> missing() const;

  /// That stamps are not of the simulated time, which is then of no use; empty: they are. Of the
  /// thread that calls place().
  const std::string& note() const { return note_; }

  /// Whether a step from `time` [s] would run ahead of a sender (SenderLag); of the thread that
  /// calls place(), as are the next three.
  bool runs_ahead(double time) const;
  /// Returns for how long at most [s of wall time].
  double begin_waiting(double time);
  void stop_waiting(double time);
  /// What tf has stopped to tell, of which nobody waits for more; empty: nothing.
  std::string stopped() const;

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
    bool plays = false;  // by stamps
    PlayedStamp played;
    SenderLag lag;
    double begun = 0.0;  // when what is played began [s]
  };
  using Latest = FrameTransformer::StampedPose;
  bool runs_ahead(double time, const Track& track) const;
  void move(double time, Track& track, Eigen::Isometry3d& pose);
  void take(double time, const Latest& latest, Track& track, const Eigen::Isometry3d& pose);
  Eigen::Isometry3d played_pose(double time, const Latest& latest, Track& track) const;

  const FrameTransformer& frames_;
  bool stamps_are_simulated_;
  std::string note_;
  std::vector<Track> tracks_;
};

}  // namespace pliant
