#include "pliant/ros/frame_transformer.h"

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

FrameTransformer::FrameTransformer(std::string target, std::vector<std::string> links)
    : target_(std::move(target)), links_(std::move(links)), listener_(buffer_) {}

Eigen::Isometry3d FrameTransformer::from(const std::string& frame) const {
  if (frame.empty() || frame == target_) return Eigen::Isometry3d::Identity();
  // tf2's own time-out follows ROS time, which may stand still.
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  std::string reason;
  while (!buffer_.canTransform(target_, frame, ros::Time(0), &reason)) {
    if (std::chrono::steady_clock::now() > deadline) refuse(frame, reason);
    std::this_thread::sleep_for(kPoll);
    reason.clear();
  }
  try {
    return tf2::transformToEigen(buffer_.lookupTransform(target_, frame, ros::Time(0)));
  } catch (const tf2::TransformException& error) {
    refuse(frame, error.what());
  }
}

void FrameTransformer::refuse(const std::string& frame, const std::string& reason) const {
  std::vector<std::string> known;
  buffer_._getFrameStrings(known);
  if (std::find(known.begin(), known.end(), target_) == known.end()) known.push_back(target_);
  if (std::find(known.begin(), known.end(), frame) != known.end()) {
    throw InputError("reference_frame: no transform from '" + frame + "' to '" + target_ +
                     "': " + reason);
  }
  if (std::find(links_.begin(), links_.end(), frame) != links_.end()) {
    throw InputError("reference_frame: nobody says in tf where the robot link '" + frame +
                     "' is: start a robot_state_publisher, or the node with "
                     "_publish_robot_tf:=true");
  }
  throw InputError("reference_frame: " + unknown_name_message("frame", frame, known));
}

}  // namespace pliant
