#pragma once

#include <functional>
#include <memory>
#include <string>

#include "pliant/ros/running/simulation_thread.h"
#include "pliant/scene/robot/inverse_kinematics.h"
#include "pliant/scene/robot/robot_hand.h"

namespace pliant {

/// What the mouse does with a robot: where the hand is to be becomes joint positions, outside of
/// the simulation's thread, since inverse kinematics may take longer than a step. One thread at a
/// time.
class HandControl {
 public:
  /// `link`: the hand's; "": find_hand(), null where that finds none. `usual`: what moves the robot
  /// until somebody takes it, or null. Throws InputError for a link that the robot does not have or
  /// that no joint moves. `world` outlives it.
  static std::unique_ptr<HandControl> make(std::shared_ptr<const Robot> robot,
                                           std::shared_ptr<JointSource> usual,
                                           const std::string& link, const World& world);

  /// For the driver of a robot that keyframes move, through the hand. Any other robot gets a driver
  /// with the first command: one that nobody takes costs nothing.
  std::shared_ptr<JointSource> source();
  /// The source of the robot's joint positions.
  const std::shared_ptr<RobotHand>& hand() const { return hand_; }
  const std::string& link() const { return link_; }
  /// How far the hand is from the root at first [m].
  double reach() const;
  bool can_turn() const { return can_turn_; }

  /// World from the hand.
  Eigen::Isometry3d pose(SimulationThread& simulation) const;
  /// The joints go to where the hand is at `world_from_hand`, or as near to it as they reach.
  Answer move_to(const Eigen::Isometry3d& world_from_hand, SimulationThread& simulation);
  /// Has `command` done, which returns what it did.
  Answer command(SimulationThread& simulation,
                 const std::function<std::string(RobotHand&)>& command);

 private:
  HandControl(std::shared_ptr<const Robot> robot, const std::string& link,
              InverseKinematics kinematics);

  std::shared_ptr<const Robot> robot_;
  std::string link_;
  InverseKinematics kinematics_;
  bool can_turn_ = false;
  bool is_driving_ = false;
  std::shared_ptr<RobotHand> hand_;
};

}  // namespace pliant
