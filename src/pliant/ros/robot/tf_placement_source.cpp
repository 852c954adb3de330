#include "pliant/ros/robot/tf_placement_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

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
                                     bool stamps_are_simulated, const FrameTransformer& frames)
    : frames_(frames), stamps_are_simulated_(stamps_are_simulated) {
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

bool TfPlacementSource::runs_ahead(double time, const Track& track) const {
  if (!track.plays || !track.lag.is_long(time)) return false;
  const auto latest = frames_.latest(track.parent, track.child);
  return latest && track.lag.is_long(time, latest->stamp.toSec());
}

bool TfPlacementSource::runs_ahead(double time) const {
  return std::any_of(tracks_.begin(), tracks_.end(),
                     [&](const Track& track) { return runs_ahead(time, track); });
}

double TfPlacementSource::begin_waiting(double time) {
  double patience = 0.0;
  for (Track& track : tracks_) {
    if (runs_ahead(time, track)) patience = std::max(patience, track.lag.begin_waiting());
  }
  return patience;
}

void TfPlacementSource::stop_waiting(double time) {
  for (Track& track : tracks_) {
    if (runs_ahead(time, track)) track.lag.give_up();
  }
}

std::string TfPlacementSource::stopped() const {
  for (const Track& track : tracks_) {
    if (track.lag.has_stopped()) {
      return fmt::format("'{}' is stamped {:.6g} s in tf", track.child, track.lag.newest());
    }
  }
  return "";
}

/// A transform that is new.
void TfPlacementSource::take(double time, const Latest& latest, Track& track,
                             const Eigen::Isometry3d& pose) {
  const double stamp = latest.stamp.toSec(), last = track.stamp.toSec();
  const bool played_before = std::exchange(track.plays, false);
  track.stamp = latest.stamp;
  track.target = latest.pose * track.child_from_link;
  // One that is static is true at any time.
  if (stamps_are_simulated_ && !latest.stamp.isZero()) {
    track.plays = PlayedStamp::is_simulated(stamp, time);
    if (!track.plays && note_.empty()) {
      note_ = fmt::format(
          "tf_stamps: '{}' is stamped {:.6g} s in tf at {:.6g} s: the stamp is not of the time on "
          "/clock, so that it moves from transform to transform as these arrive; give their sender "
          "use_sim_time",
          track.child, stamp, time);
    }
  }
  if (!track.plays) {
    track.start = pose;
    track.motion.start(time);
    return;
  }
  track.lag.add(stamp);
  bool begins = !played_before;
  if (begins) {
    track.played.clear();
    track.played.begin(stamp, time);
  } else {
    begins = track.played.follow(last, stamp, time);
  }
  if (!begins) return;
  track.start = pose;
  track.begun = time;
}

/// From where it was when that began, it goes over to what is played.
Eigen::Isometry3d TfPlacementSource::played_pose(double time, const Latest& latest,
                                                 Track& track) const {
  track.played.play(time);
  const double stamp = std::max(0.0, std::min(track.played.stamp(), latest.stamp.toSec()));
  const auto known = frames_.at(track.parent, track.child, ros::Time(stamp));
  const Eigen::Isometry3d aim = known ? *known * track.child_from_link : track.target;
  return between(track.start, aim, (time - track.begun) / PlayedStamp::kMaxPeriod);
}

void TfPlacementSource::move(double time, Track& track, Eigen::Isometry3d& pose) {
  const auto latest = frames_.latest(track.parent, track.child);
  const bool jumps = track.motion.restarts(time);
  if (latest && (!track.is_known || latest->stamp != track.stamp)) {
    track.is_known = true;
    take(time, *latest, track, pose);
  }
  if (track.is_known && jumps) {
    pose = track.start = track.target;
    track.plays = false;
    track.lag = SenderLag();
  } else if (track.plays && latest) {
    pose = played_pose(time, *latest, track);
  } else if (track.is_known) {
    pose = between(track.start, track.target, track.motion.share(time));
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
