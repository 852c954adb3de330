#include "pliant/scene/robot/motion/robot_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "pliant/scene/robot/robot_data.h"

namespace pliant {
namespace {

/// What the URDF allows, or a careful speed where it does not say [m/s or rad/s].
double speed_of(const Robot& robot, int joint) {
  const double allowed = robot.limits(joint).velocity;
  if (std::isfinite(allowed)) return allowed;
  for (const Robot::Data::Link& link : robot.data().links) {
    if (link.joint == joint && link.segment.getJoint().getType() == KDL::Joint::TransAxis) {
      return RobotHand::kLinearSpeed;
    }
  }
  return RobotHand::kAngularSpeed;
}

}  // namespace

RobotHand::RobotHand(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> usual,
                     std::vector<FingerJoint> fingers, const World& world)
    : robot_(std::move(robot)),
      usual_(std::move(usual)),
      fingers_(std::move(fingers)),
      world_(world),
      now_(robot_->initial_positions()),
      goal_(now_) {
  for (const FingerJoint& finger : fingers_) {
    finger_links_.push_back(links_moved_by(*robot_, finger.joint));
  }
  for (int j = 0; j < static_cast<int>(now_.size()); ++j) speeds_.push_back(speed_of(*robot_, j));
}

void RobotHand::take() {
  if (!is_taken()) goal_ = now_;
  state_ = State::kTaken;
}

void RobotHand::move_to(const std::vector<double>& positions) {
  const bool are_finite = std::all_of(positions.begin(), positions.end(),
                                      [](double value) { return std::isfinite(value); });
  if (positions.size() != now_.size() || !are_finite) {
    throw InputError(fmt::format("hand: {} joint positions, but must be {} finite ones",
                                 positions.size(), now_.size()));
  }
  take();
  std::vector<double> goal = positions;
  for (const FingerJoint& finger : fingers_) {
    const auto j = static_cast<std::size_t>(finger.joint);
    goal[j] = goal_[j];
  }
  goal_ = std::move(goal);
}

void RobotHand::move_fingers(bool open) {
  if (fingers_.empty()) {
    throw InputError(fmt::format("robot '{}' has no fingers to open and close", robot_->name()));
  }
  take();
  for (const FingerJoint& finger : fingers_) {
    goal_[static_cast<std::size_t>(finger.joint)] = open ? finger.open : finger.closed;
  }
}

void RobotHand::open() {
  move_fingers(true);
  grip_force_ = 0.0;
}

void RobotHand::close(double force) {
  move_fingers(false);
  grip_force_ = force;
}

void RobotHand::stop() {
  take();
  goal_ = now_;
  grip_force_ = 0.0;
}

void RobotHand::give_back() {
  if (is_taken()) state_ = State::kReturning;
  grip_force_ = 0.0;
}

double RobotHand::force_on(const FingerJoint& finger) const {
  const auto number = static_cast<std::size_t>(&finger - fingers_.data());
  const std::vector<std::string>& links = finger_links_[number];
  double largest = 0.0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  const auto& obstacles = world_.obstacles();
  for (const std::string& link : links) {
    force.setZero();
    for (std::size_t o = 0; o < obstacles.size() && o < world_.reactions().size(); ++o) {
      if (obstacles[o].link == link) force += world_.reactions()[o].force;
    }
    largest = std::max(largest, force.norm());
  }
  return largest;
}

/// All joints arrive together, the slowest as fast as it may.
void RobotHand::move_on(double dt) {
  double needed = 0.0;  // [s]
  for (std::size_t j = 0; j < now_.size(); ++j) {
    needed = std::max(needed, std::abs(goal_[j] - now_[j]) / speeds_[j]);
  }
  if (needed <= dt) {
    now_ = goal_;
    return;
  }
  for (std::size_t j = 0; j < now_.size(); ++j) now_[j] += dt / needed * (goal_[j] - now_[j]);
}

void RobotHand::positions(double time, std::vector<double>& positions) {
  if (time == 0.0 || time < last_time_) {  // a reset, or a state that was loaded
    state_ = State::kUsual;
    held_up_ = grip_force_ = 0.0;
    last_time_ = time;
    if (!usual_) positions = robot_->initial_positions();
  }
  const double dt = time - last_time_;
  last_time_ = time;
  if (state_ == State::kUsual) {
    if (usual_) usual_->positions(time - held_up_, positions);
    now_ = goal_ = positions;
    return;
  }
  held_up_ += dt;
  if (state_ == State::kReturning) {
    goal_ = usual_ ? now_ : robot_->initial_positions();
    if (usual_) usual_->positions(time - held_up_, goal_);
  }
  for (const FingerJoint& finger : fingers_) {
    if (grip_force_ == 0.0 || force_on(finger) < grip_force_) continue;
    for (const FingerJoint& each : fingers_) {
      goal_[static_cast<std::size_t>(each.joint)] = now_[static_cast<std::size_t>(each.joint)];
    }
    grip_force_ = 0.0;
  }
  move_on(dt);
  if (state_ == State::kReturning && now_ == goal_) state_ = State::kUsual;
  positions = now_;
}

}  // namespace pliant
