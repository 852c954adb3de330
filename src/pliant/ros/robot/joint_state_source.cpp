#include "pliant/ros/robot/joint_state_source.h"

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"

namespace pliant {

JointStateSource::JointStateSource(std::shared_ptr<const Robot> robot)
    : robot_(std::move(robot)),
      requested_(robot_->initial_positions()),
      target_(requested_),
      start_(requested_),
      difference_(requested_.size(), 0.0) {}

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
  fresh_ = true;
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
  motion_.start(time);
}

void JointStateSource::positions(double time, std::vector<double>& positions) {
  start_motion(time, positions);
  if (motion_.restarts(time)) {
    positions = target_;
    start_ = target_;
    std::fill(difference_.begin(), difference_.end(), 0.0);
  } else {
    const double share = motion_.share(time);
    for (std::size_t j = 0; j < target_.size(); ++j) {
      positions[j] = start_[j] + share * difference_[j];
    }
  }
  motion_.end_step(time);
}

}  // namespace pliant
