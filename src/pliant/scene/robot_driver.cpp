#include <cmath>

#include "pliant/scene/robot.h"

namespace pliant {

RobotDriver::RobotDriver(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> source)
    : robot_(std::move(robot)),
      source_(std::move(source)),
      positions_(robot_->initial_positions()),
      requested_(positions_) {}

void RobotDriver::find_links(const std::vector<Obstacle>& obstacles) {
  link_of_obstacle_.clear();
  for (const Obstacle& obstacle : obstacles) {
    link_of_obstacle_.push_back(robot_->link_index(obstacle.link).value_or(-1));
  }
}

void RobotDriver::drive(double time, std::vector<Obstacle>& obstacles) {
  if (link_of_obstacle_.size() != obstacles.size()) find_links(obstacles);
  requested_ = positions_;
  source_->positions(time, requested_);
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    if (std::isfinite(requested_[i])) positions_[i] = requested_[i];
  }
  robot_->link_poses(positions_, poses_);
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const int link = link_of_obstacle_[i];
    if (link < 0) continue;
    obstacles[i].pose_end = poses_[static_cast<std::size_t>(link)] * obstacles[i].link_from_shape;
  }
}

}  // namespace pliant
