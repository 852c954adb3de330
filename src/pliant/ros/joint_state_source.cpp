#include "pliant/ros/joint_state_source.h"

#include <ros/console.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {

JointStateSource::JointStateSource(std::shared_ptr<const Robot> robot)
    : robot_(std::move(robot)),
      requested_(robot_->initial_positions()),
      target_(requested_),
      start_(requested_),
      difference_(requested_.size(), 0.0),
      last_warning_(std::chrono::steady_clock::now() - std::chrono::hours(1)) {}

void JointStateSource::set(const sensor_msgs::JointState& message) {
  for (std::size_t j = 0; j < message.position.size(); ++j) {
    if (!(std::abs(message.position[j]) <= kMaxPosition)) {
      const std::string name = j < message.name.size() ? message.name[j] : std::to_string(j);
      throw InputError("joint '" + name + "' is " + std::to_string(message.position[j]) +
                       ", but must be finite and at most 1e6 [m or rad]");
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  robot_->set_positions(message.name, message.position, requested_);
  received_ = fresh_ = true;
}

void JointStateSource::on_message(const sensor_msgs::JointStateConstPtr& message) {
  try {
    set(*message);
  } catch (const std::exception& error) {
    // Not ROS_WARN_THROTTLE, which is silent while ROS time stands still at 0.
    const auto now = std::chrono::steady_clock::now();
    if (now - last_warning_ < std::chrono::seconds(5)) return;
    last_warning_ = now;
    ROS_WARN("joint_states: message refused, the robot stays where it is: %s", error.what());
  }
}

bool JointStateSource::received() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return received_;
}

void JointStateSource::start_motion(double time, const std::vector<double>& positions) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!fresh_) return;
    target_ = requested_;
    fresh_ = false;
  }
  for (std::size_t j = 0; j < target_.size(); ++j) {
    start_[j] = positions[j];
    difference_[j] = target_[j] - start_[j];
    const bool turns_without_end = std::isinf(robot_->limits(static_cast<int>(j)).lower);
    if (turns_without_end) difference_[j] = std::remainder(difference_[j], 2.0 * M_PI);
  }
  // Motion begins where the last step ended, so that it shows in the step that runs.
  if (last_message_ < 0.0) {
    period_ = kMaxPeriod;
  } else {
    // Messages that come in a bunch must not make the robot jump.
    period_ = std::clamp(time - last_message_, 0.5 * period_, kMaxPeriod);
  }
  last_message_ = time;
  motion_start_ = last_time_;
}

void JointStateSource::positions(double time, std::vector<double>& positions) {
  const bool restarted = time == 0.0 || time < last_time_;
  start_motion(time, positions);
  if (restarted) {
    last_message_ = -1.0;
    positions = target_;
    start_ = target_;
    std::fill(difference_.begin(), difference_.end(), 0.0);
  } else {
    const double share = std::clamp((time - motion_start_) / period_, 0.0, 1.0);
    for (std::size_t j = 0; j < target_.size(); ++j) {
      positions[j] = start_[j] + share * difference_[j];
    }
  }
  last_time_ = time;
}

}  // namespace pliant
