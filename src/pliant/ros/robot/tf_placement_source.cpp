#include "pliant/ros/robot/tf_placement_source.h"

#include <fmt/format.h>

namespace pliant {
namespace {

Eigen::Isometry3d between(const Eigen::Isometry3d& start, const Eigen::Isometry3d& target,
                          double share) {
  if (share >= 1.0) return target;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = start.translation() + share * (target.translation() - start.translation());
  pose.linear() = Eigen::Quaterniond(start.linear())
                      .slerp(share, Eigen::Quaterniond(target.linear()))
                      .toRotationMatrix();
  return pose;
}

}  // namespace

TfPlacementSource::TfPlacementSource(const Robot& robot, const std::string& base_frame,
                                     const FrameTransformer& frames)
    : frames_(frames) {
  if (!base_frame.empty()) {
    Track base;
    base.what = "base_frame";
    base.parent = frames.target();
    base.child = base_frame;
    base.child_from_link = robot.initial_placement().world_from_base;
    tracks_.push_back(base);
  }
  for (std::size_t f = 0; f < robot.free_joints().size(); ++f) {
    const Robot::FreeJoint& joint = robot.free_joints()[f];
    Track track;
    track.what = joint.type + " joint '" + joint.name + "'";
    track.parent = joint.parent;
    track.child = joint.child;
    track.free = static_cast<int>(f);
    tracks_.push_back(track);
  }
}

std::vector<std::string> TfPlacementSource::missing() const {
  std::vector<std::string> texts;
  for (const Track& track : tracks_) {
    if (frames_.latest(track.parent, track.child)) continue;
    texts.push_back(fmt::format("{}: {}", track.what, frames_.why_not(track.parent, track.child)));
  }
  return texts;
}

void TfPlacementSource::move(double time, Track& track, Eigen::Isometry3d& pose) const {
  const auto latest = frames_.latest(track.parent, track.child);
  if (latest && (!track.is_known || latest->stamp != track.stamp)) {
    track.is_known = true;
    track.stamp = latest->stamp;
    track.start = pose;
    track.target = latest->pose * track.child_from_link;
    track.motion.start(time);
  }
  if (track.is_known) {
    const bool jumps = track.motion.restarts(time);
    pose = jumps ? track.target : between(track.start, track.target, track.motion.share(time));
    if (jumps) track.start = track.target;
  }
  track.motion.end_step(time);
}

void TfPlacementSource::place(double time, Robot::Placement& placement) {
  for (Track& track : tracks_) {
    const auto free = static_cast<std::size_t>(track.free);
    move(time, track, track.free < 0 ? placement.world_from_base : placement.free[free]);
  }
}

}  // namespace pliant
