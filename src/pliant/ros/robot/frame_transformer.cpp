#include "pliant/ros/robot/frame_transformer.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "pliant/math/error.h"
#include "pliant/ros/conversions.h"

namespace pliant {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(250);
constexpr auto kPoll = std::chrono::milliseconds(10);

}  // namespace

FrameTransformer::FrameTransformer(std::string target, bool listens) : target_(std::move(target)) {
  if (listens) listener_ = std::make_unique<tf2_ros::TransformListener>(buffer_);
}

FrameTransformer::FrameTransformer(std::string target)
    : FrameTransformer(std::move(target), true) {}

std::unique_ptr<FrameTransformer> FrameTransformer::without_listener(std::string target) {
  return std::unique_ptr<FrameTransformer>(new FrameTransformer(std::move(target), false));
}

void FrameTransformer::hear(const geometry_msgs::TransformStamped& transform, bool is_static) {
  buffer_.setTransform(transform, "hear", is_static);
}

Eigen::Isometry3d FrameTransformer::from(const std::string& frame,
                                         const std::vector<std::string>& others) const {
  if (frame.empty() || frame == target_) return Eigen::Isometry3d::Identity();
  // tf2's own time-out follows ROS time, which may stand still.
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  std::string reason;
  while (!buffer_.canTransform(target_, frame, ros::Time(0), &reason)) {
    if (std::chrono::steady_clock::now() > deadline) refuse(frame, reason, others);
    std::this_thread::sleep_for(kPoll);
    reason.clear();
  }
  try {
    return tf2::transformToEigen(buffer_.lookupTransform(target_, frame, ros::Time(0)));
  } catch (const tf2::TransformException& error) {
    refuse(frame, error.what(), others);
  }
}

std::optional<FrameTransformer::StampedPose> FrameTransformer::latest(
    const std::string& parent, const std::string& child) const {
  if (!buffer_.canTransform(parent, child, ros::Time(0))) return std::nullopt;
  try {
    const auto found = buffer_.lookupTransform(parent, child, ros::Time(0));
    return StampedPose{found.header.stamp, tf2::transformToEigen(found)};
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

std::optional<Eigen::Isometry3d> FrameTransformer::at(const std::string& parent,
                                                      const std::string& child,
                                                      const ros::Time& stamp) const {
  if (!buffer_.canTransform(parent, child, stamp)) return std::nullopt;
  try {
    return tf2::transformToEigen(buffer_.lookupTransform(parent, child, stamp));
  } catch (const tf2::TransformException&) {
    return std::nullopt;
  }
}

std::string FrameTransformer::why_not(const std::string& parent, const std::string& child) const {
  const std::vector<std::string> known = known_frames();
  for (const std::string& frame : {parent, child}) {
    if (std::find(known.begin(), known.end(), frame) != known.end()) continue;
    const std::string nearest = nearest_name(frame, known);
    return "tf knows no frame '" + frame + "'" +
           (nearest.empty() ? "" : "; did you mean '" + nearest + "'?");
  }
  return "tf has no transform from '" + child + "' to '" + parent + "'";
}

std::vector<std::string> FrameTransformer::known_frames() const {
  std::vector<std::string> known;
  buffer_._getFrameStrings(known);
  if (std::find(known.begin(), known.end(), target_) == known.end()) known.push_back(target_);
  return known;
}

void FrameTransformer::refuse(const std::string& frame, const std::string& reason,
                              const std::vector<std::string>& others) const {
  std::vector<std::string> known = known_frames();
  if (std::find(known.begin(), known.end(), frame) != known.end()) {
    throw InputError("reference_frame: no transform from '" + frame + "' to '" + target_ +
                     "': " + reason);
  }
  known.insert(known.end(), others.begin(), others.end());
  throw InputError("reference_frame: " + unknown_name_message("frame", frame, known));
}

}  // namespace pliant
