#include "pliant/ros/robot/joint_state_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kEarly = 1e-6;             // round-off of stamps [s]
constexpr double kEndOfLastRun = 0.5;       // until when messages of the run before may come [s]
constexpr std::size_t kMostWaiting = 1000;  // messages, while no step is made

}  // namespace

JointStateSource::JointStateSource(std::shared_ptr<const Robot> robot, bool stamps_are_simulated)
    : robot_(std::move(robot)),
      stamps_are_simulated_(stamps_are_simulated),
      requested_(robot_->initial_positions()),
      target_(requested_),
      start_(requested_),
      difference_(requested_.size(), 0.0),
      path_(requested_.size()),
      last_(requested_.size(), std::numeric_limits<double>::quiet_NaN()),
      offset_(requested_.size(), 0.0),
      path_start_(requested_.size(), 0.0) {}

void JointStateSource::set(const sensor_msgs::JointState& message) {
  for (std::size_t j = 0; j < message.position.size(); ++j) {
    if (!(std::abs(message.position[j]) <= kMaxPosition)) {
      const std::string name = j < message.name.size() ? message.name[j] : std::to_string(j);
      throw InputError("joint '" + name + "' is " + std::to_string(message.position[j]) +
                       ", but must be finite and at most 1e6 [m or rad]");
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  of_message_.assign(requested_.size(), std::numeric_limits<double>::quiet_NaN());
  robot_->set_positions(message.name, message.position, of_message_);
  bool is_of_robot = false;
  for (std::size_t j = 0; j < requested_.size(); ++j) {
    if (!std::isfinite(of_message_[j])) continue;
    requested_[j] = of_message_[j];
    is_of_robot = true;
  }
  // Those of another robot neither begin a motion nor tell whether the sender of this one is late.
  if (!is_of_robot) return;
  if (messages_.size() >= kMostWaiting) messages_.erase(messages_.begin());
  messages_.push_back({message.header.stamp.toSec(), of_message_});
}

std::string JointStateSource::note() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return note_;
}

std::vector<JointStateSource::Message> JointStateSource::take_messages() {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Message> messages;
  messages.swap(messages_);
  return messages;
}

double JointStateSource::change(std::size_t joint, double from, double to) const {
  const bool turns_without_end = std::isinf(robot_->limits(static_cast<int>(joint)).lower);
  return turns_without_end ? std::remainder(to - from, 2.0 * M_PI) : to - from;
}

void JointStateSource::begin_run(double time, std::vector<double>& positions) {
  run_start_ = time;
  follows_path_ = false;
  lag_ = SenderLag();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const Message& message : messages_) {
      if (knows_time(message, time)) lag_.add(message.stamp);
    }
    messages_.clear();
    target_ = requested_;
  }
  positions = start_ = target_;
  std::fill(difference_.begin(), difference_.end(), 0.0);
}

bool JointStateSource::is_of_last_run(const Message& message, double time) const {
  return stamps_are_simulated_ && message.stamp > time + kEarly &&
         time < run_start_ + kEndOfLastRun;
}

bool JointStateSource::knows_time(const Message& message, double time) const {
  return stamps_are_simulated_ && PlayedStamp::is_simulated(message.stamp, time);
}

bool JointStateSource::runs_ahead(double time) const {
  if (!lag_.is_long(time)) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  double newest = lag_.newest();
  for (const Message& message : messages_) newest = std::max(newest, message.stamp);
  return lag_.is_long(time, newest);
}

void JointStateSource::follow(const Message& message, double time,
                              const std::vector<double>& positions) {
  if (!follows_path_) {
    path_.clear();
    std::fill(last_.begin(), last_.end(), std::numeric_limits<double>::quiet_NaN());
    follows_path_ = true;
  }
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (!std::isfinite(message.positions[j])) continue;
    const double from = std::isnan(last_[j]) ? positions[j] : last_[j];
    last_[j] = from + change(j, from, message.positions[j]);
    if (!path_.add(j, message.stamp, last_[j], time)) continue;
    path_start_[j] = time;
    offset_[j] = positions[j] - last_[j];
  }
}

void JointStateSource::start_motion(const Message& message, double time,
                                    const std::vector<double>& positions) {
  follows_path_ = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    target_ = requested_;
  }
  for (std::size_t j = 0; j < target_.size(); ++j) {
    start_[j] = positions[j];
    difference_[j] = change(j, start_[j], target_[j]);
  }
  motion_.start(time);
  if (!stamps_are_simulated_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!note_.empty()) return;
  note_ = fmt::format(
      "joint_stamps: joint_states stamped {:.6g} s came at {:.6g} s: the stamps are not of the "
      "time on /clock, so that joints move from message to message as these arrive; give their "
      "sender use_sim_time, and a stamp to each",
      message.stamp, time);
}

void JointStateSource::move(double time, std::vector<double>& positions) const {
  const double share = motion_.share(time);
  for (std::size_t j = 0; j < positions.size(); ++j) {
    if (!follows_path_) {
      positions[j] = start_[j] + share * difference_[j];
    } else if (!std::isnan(last_[j])) {
      const double begun = std::min(1.0, (time - path_start_[j]) / PlayedStamp::kMaxPeriod);
      positions[j] = path_.position(j) + (1.0 - begun) * offset_[j];
    }
  }
}

void JointStateSource::positions(double time, std::vector<double>& positions) {
  if (motion_.restarts(time)) {
    begin_run(time, positions);
  } else {
    const std::vector<Message> messages = take_messages();
    const Message* timeless = nullptr;
    for (const Message& message : messages) {
      if (is_of_last_run(message, time)) continue;
      if (knows_time(message, time)) {
        lag_.add(message.stamp);
        follow(message, time, positions);
      } else {
        timeless = &message;
      }
    }
    if (timeless != nullptr) start_motion(*timeless, time, positions);
    if (follows_path_) path_.play(time);
    move(time, positions);
  }
  motion_.end_step(time);
}

}  // namespace pliant
