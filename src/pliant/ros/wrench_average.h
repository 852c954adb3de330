#pragma once

#include <pliant/LinkWrench.h>

#include <vector>

#include "pliant/core/obstacle.h"

namespace pliant {

/// Mean force and torque on each robot link and obstacle over some steps.
class WrenchAverage {
 public:
  /// Obstacles keep their number, order, names and links.
  explicit WrenchAverage(const std::vector<Obstacle>& obstacles);

  /// Takes in one step. `reactions`: one an obstacle.
  void add(const std::vector<Obstacle>& obstacles, const std::vector<Reaction>& reactions);
  /// Mean since the last call, or what that call gave when there was no step. Robot links first,
  /// all shapes of a link together.
  const std::vector<LinkWrench>& take();
  /// Forgets all steps.
  void clear();

 private:
  struct Sum {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // [N m]
  };

  std::vector<std::size_t> slots_;  // of each obstacle: its place in sums_ and means_
  std::vector<Sum> sums_;
  std::vector<LinkWrench> means_;
  int steps_ = 0;
};

}  // namespace pliant
