#pragma once

#include <algorithm>

#include "pliant/core/obstacle.h"

namespace pliant {

/// Moves one obstacle straight, from its first pose, and stops it after a while.
class StraightDriver final : public ObstacleDriver {
 public:
  StraightDriver(std::size_t obstacle, const Eigen::Isometry3d& start,
                 const Eigen::Vector3d& velocity, double duration)
      : obstacle_(obstacle), start_(start), velocity_(velocity), duration_(duration) {}

  void drive(double time, std::vector<Obstacle>& obstacles) override {
    const Eigen::Translation3d motion(std::min(time, duration_) * velocity_);
    obstacles[obstacle_].pose_end = motion * start_;
  }

 private:
  std::size_t obstacle_;
  Eigen::Isometry3d start_;
  Eigen::Vector3d velocity_;  // [m/s]
  double duration_;           // [s]
};

}  // namespace pliant
