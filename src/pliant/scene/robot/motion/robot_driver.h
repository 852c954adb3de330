#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "pliant/scene/robot/motion/joint_loads.h"
#include "pliant/scene/robot/motion/stalling_joints.h"
#include "pliant/scene/robot/robot.h"

namespace pliant {

/// Moves the obstacles of a robot's links as sources of joint positions and poses say. A position
/// that is not finite is left out: the joint stays where it is; one beyond its limits is clamped
/// where Robot::limit_rule() says so. drive() allocates nothing after its first call but what it
/// has to note.
class RobotDriver final : public ObstacleDriver {
 public:
  /// `source` may be null: then the joints stay; `placement` may be null: then the base does.
  RobotDriver(std::shared_ptr<const Robot> robot, std::shared_ptr<JointSource> source,
              std::shared_ptr<PlacementSource> placement = nullptr);
  void drive(double time, std::vector<Obstacle>& obstacles) override;
  /// Where the robot's joints have efforts that they can reach.
  bool yields() const override { return stalling_.any(); }
  bool answer(const std::vector<Reaction>& reactions, bool last,
              std::vector<Obstacle>& obstacles) override;
  bool hold_back(std::vector<Obstacle>& obstacles) override;
  void save(StateArchive& numbers) const override;
  void load(StateArchive& numbers) override;
  /// Of the last drive(); the initial ones before.
  const std::vector<double>& positions() const { return positions_; }
  /// World from link number `link`, of the last drive().
  const Eigen::Isometry3d& link_pose(int link) const {
    return poses_[static_cast<std::size_t>(link)];
  }

  /// From now on notes() tells, besides joints that stall, of limits that are exceeded and of
  /// joints that move faster than their URDF allows, each joint once.
  void watch() { is_watching_ = true; }
  const std::vector<std::string>& notes() const { return notes_; }
  /// Those that hold: no more of joints that stalled and caught up since.
  std::vector<std::string> present_notes() const;

 private:
  struct Told {
    bool limit = false, speed = false;
  };
  void place(std::vector<Obstacle>& obstacles);
  void find_links(const std::vector<Obstacle>& obstacles);
  double within_limits(std::size_t joint, double position);
  void note_speed(std::size_t joint, double change, double time);
  /// Tells something that holds until the end.
  void note(const std::string& text);

  std::shared_ptr<const Robot> robot_;
  std::shared_ptr<JointSource> source_;
  std::shared_ptr<PlacementSource> placement_source_;
  std::vector<double> positions_;  // where the joints are
  std::vector<double> requested_;  // where they are told to be
  std::vector<double> asked_;      // what the source says
  JointLoads loads_;
  StallingJoints stalling_;
  Robot::Placement placement_;
  std::vector<Eigen::Isometry3d> poses_;
  std::vector<int> link_of_obstacle_;  // -1 for what is no link of the robot
  double last_time_ = std::numeric_limits<double>::infinity();  // of drive() [s]
  bool is_watching_ = false;
  std::vector<Told> told_;                          // of each joint
  std::vector<std::string> notes_, lasting_notes_;  // all, and those that never end
};

}  // namespace pliant
