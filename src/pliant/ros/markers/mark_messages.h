#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "pliant/core/world.h"
#include "pliant/ros/running/snapshot.h"

namespace pliant {

/// Obstacles, applied forces, attachments, contacts and fixed vertices as few markers with stable
/// ids. An array holds what changed since the last one; what ended is deleted.
class MarkMessages {
 public:
  /// `show_robot`: robot links' shapes are shown as well.
  MarkMessages(const World& world, bool show_robot);

  /// `everything`: also what did not change, for new subscribers.
  const visualization_msgs::MarkerArray& update(const Snapshot& snapshot, bool everything);

 private:
  void add(const Snapshot& snapshot, visualization_msgs::Marker marker);
  void add_obstacles(const Snapshot& snapshot, bool everything);
  void add_forces(const Snapshot& snapshot);
  void add_list(const Snapshot& snapshot, const std::vector<Eigen::Vector3d>& points,
                visualization_msgs::Marker marker, bool& shown);

  std::vector<Obstacle> obstacles_;  // names, shapes and colours
  std::vector<bool> obstacle_is_shown_;
  std::vector<Eigen::Isometry3d> sent_poses_;
  double size_ = 1.0;    // diagonal of all bodies at the start [m]
  double weight_ = 1.0;  // of all bodies [N]
  std::size_t forces_shown_ = 0;
  bool contacts_shown_ = false;
  bool fixed_shown_ = false;
  bool held_shown_ = false;
  visualization_msgs::MarkerArray array_;
};

}  // namespace pliant
