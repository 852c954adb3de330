#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "pliant/core/obstacle.h"

namespace pliant {

/// What all bodies of a scene together do to a robot link, with all its collision shapes, or to an
/// obstacle: about the origin and in the axes of its own frame (own_frame()).
struct Wrench {
  std::string name;  ///< of the link or the obstacle; no two have the same (`NAME_2`)
  bool is_robot_link = false;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();   ///< [N]
  Eigen::Vector3d torque = Eigen::Vector3d::Zero();  ///< [N m]
};

/// World from the frame of the robot link that an obstacle belongs to, or from the obstacle's own,
/// at the end of the last step.
Eigen::Isometry3d own_frame(const Obstacle& obstacle);

/// Mean wrench on each robot link and obstacle over some steps.
class WrenchAverage {
 public:
  /// Obstacles keep their number, order, names and links.
  explicit WrenchAverage(const std::vector<Obstacle>& obstacles);

  /// Takes in one step. `reactions`: one an obstacle.
  void add(const std::vector<Obstacle>& obstacles, const std::vector<Reaction>& reactions);
  /// Mean since the last call, or what that call gave when there was no step; 0 before the first.
  /// Robot links first. Allocates nothing.
  const std::vector<Wrench>& take();
  /// As take() gave them last.
  const std::vector<Wrench>& means() const { return means_; }
  /// Forgets all steps.
  void clear();

 private:
  struct Sum {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // [N]
    Eigen::Vector3d torque = Eigen::Vector3d::Zero();  // [N m]
  };
  std::size_t add_slot(const std::string& name, bool is_robot_link);

  std::vector<std::size_t> slots_;  // of each obstacle: its place in sums_ and means_
  std::vector<Sum> sums_;
  std::vector<Wrench> means_;
  int steps_ = 0;
};

/// The wrenches of a scene with such obstacles, all zero.
std::vector<Wrench> zero_wrenches(const std::vector<Obstacle>& obstacles);

/// Columns of a table: for each wrench ",NAME.force_x" and so on to ",NAME.torque_z", quoted where
/// a comma is in the name.
std::string wrench_columns(const std::vector<Wrench>& wrenches);
/// The cells of a row below them, each after a comma [N, N m].
std::string wrench_cells(const std::vector<Wrench>& wrenches);

}  // namespace pliant
