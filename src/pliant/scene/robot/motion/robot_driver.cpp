#include "pliant/scene/robot/motion/robot_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Encoders and other simulators report a joint at its limit a little beyond it [m or rad].
constexpr double kLimitMargin = 1e-4;
// Messages that come unevenly make a joint seem to move up to twice as fast as it does.
constexpr double kSpeedMargin = 2.0;

}  // namespace

RobotDriver::RobotDriver(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> source,
                         std::shared_ptr<PlacementSource> placement)
    : robot_(std::move(robot)),
      source_(std::move(source)),
      placement_source_(std::move(placement)),
      positions_(robot_->initial_positions()),
      requested_(positions_),
      loads_(*robot_),
      stalling_(*robot_),
      placement_(robot_->initial_placement()),
      told_(positions_.size()) {
  robot_->link_poses(positions_, placement_, poses_);
}

void RobotDriver::find_links(const std::vector<Obstacle>& obstacles) {
  link_of_obstacle_.clear();
  for (const Obstacle& obstacle : obstacles) {
    link_of_obstacle_.push_back(robot_->link_index(obstacle.link).value_or(-1));
  }
}

double RobotDriver::within_limits(std::size_t joint, double position) {
  const JointLimitRule rule = robot_->limit_rule();
  const Robot::Limits limits = robot_->limits(static_cast<int>(joint));
  const double nearest = std::clamp(position, limits.lower, limits.upper);
  if (rule == JointLimitRule::kIgnore || nearest == position) return position;
  const bool is_clamped = rule == JointLimitRule::kClamp;
  if (is_watching_ && !told_[joint].limit && std::abs(position - nearest) > kLimitMargin) {
    told_[joint].limit = true;
    note(fmt::format(
        "joint_limit: joint '{}' is told to go to {:.4g} {}, beyond its limits {:g} to {:g}: it {}",
        robot_->joint_names()[joint], position, robot_->unit(static_cast<int>(joint)), limits.lower,
        limits.upper,
        is_clamped ? "stays within them" : "goes there; 'limits: clamp' keeps it within them"));
  }
  return is_clamped ? nearest : position;
}

void RobotDriver::note_speed(std::size_t joint, double change, double time) {
  const double duration = time - last_time_;
  const double allowed = robot_->limits(static_cast<int>(joint)).velocity;
  // Time that was put back begins a run anew: there joints may jump.
  if (!(duration > 0.0) || !(std::abs(change) > kSpeedMargin * allowed * duration)) return;
  if (told_[joint].speed) return;
  told_[joint].speed = true;
  const char* const unit = robot_->unit(static_cast<int>(joint));
  note(fmt::format(
      "joint_jump: joint '{}' moved at {:.3g} {}/s at {:.4g} s, but its URDF allows {:g} {}/s: "
      "what it touches is hit, or passed through",
      robot_->joint_names()[joint], std::abs(change) / duration, unit, time, allowed, unit));
}

void RobotDriver::note(const std::string& text) {
  notes_.push_back(text);
  lasting_notes_.push_back(text);
}

std::vector<std::string> RobotDriver::present_notes() const {
  std::vector<std::string> notes = lasting_notes_;
  stalling_.note_present(notes);
  return notes;
}

void RobotDriver::drive(double time, std::vector<Obstacle>& obstacles) {
  if (link_of_obstacle_.size() != obstacles.size()) find_links(obstacles);
  asked_ = requested_;
  if (source_) source_->positions(time, asked_);
  if (placement_source_) placement_source_->place(time, placement_);
  for (std::size_t i = 0; i < requested_.size(); ++i) {
    if (!std::isfinite(asked_[i])) continue;
    const double position = within_limits(i, asked_[i]);
    if (is_watching_) note_speed(i, position - requested_[i], time);
    requested_[i] = position;
  }
  const double duration = time - last_time_;
  last_time_ = time;
  // Time that was put back begins a run anew.
  if (!(duration >= 0.0)) stalling_.reset();
  stalling_.advance(requested_, std::max(0.0, duration), positions_);
  stalling_.note_first(notes_);
  place(obstacles);
}

void RobotDriver::place(std::vector<Obstacle>& obstacles) {
  robot_->link_poses(positions_, placement_, poses_);
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const int link = link_of_obstacle_[i];
    if (link < 0) continue;
    obstacles[i].pose_end = poses_[static_cast<std::size_t>(link)] * obstacles[i].link_from_shape;
  }
}

bool RobotDriver::answer(const std::vector<Reaction>& reactions, bool last,
                         std::vector<Obstacle>& obstacles) {
  const auto& loads = loads_.find(poses_, link_of_obstacle_, obstacles, reactions);
  if (!stalling_.answer(loads, last, positions_)) return false;
  place(obstacles);
  return true;
}

bool RobotDriver::hold_back(std::vector<Obstacle>& obstacles) {
  // All others move as they did.
  const bool can = stalling_.hold_back(positions_);
  place(obstacles);
  return can;
}

void RobotDriver::save(StateArchive& numbers) const {
  if (!yields()) return;
  numbers.write(last_time_);
  for (const double position : positions_) numbers.write(position);
  stalling_.save(numbers);
}

void RobotDriver::load(StateArchive& numbers) {
  if (!yields()) return;
  last_time_ = numbers.read();
  for (double& position : positions_) {
    const double saved = numbers.read();
    if (std::isfinite(saved)) position = saved;
  }
  stalling_.load(numbers);
}

}  // namespace pliant
