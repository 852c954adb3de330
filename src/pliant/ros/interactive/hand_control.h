#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/ros/running/simulation_thread.h"
#include "pliant/scene/robot/motion/inverse_kinematics.h"
#include "pliant/scene/robot/motion/robot_hand.h"
#include "pliant/scene/scene.h"

namespace pliant {

/// What the mouse does with a robot: where the hand is to be becomes joint positions, outside of
/// the simulation's thread, since inverse kinematics may take longer than a step. One thread at a
/// time.
class HandControl {
 public:
  /// Of the scene's robot of that index. `link`: the hand's; "": find_hand(), null where that finds
  /// none. The robot's keyframes go through the hand, if it has some. Throws InputError for a link
  /// that the robot does not have or that no joint moves. The scene's world outlives it.
  static std::unique_ptr<HandControl> make(LoadedScene& scene, std::size_t robot,
                                           const std::string& link);

  /// The source of the robot's joint positions.
  const std::shared_ptr<RobotHand>& hand() const { return hand_; }
  const std::string& link() const { return link_; }
  /// What its marker is called: "hand" after the robot's prefix; several that are called alike are
  /// numbered from the second on.
  const std::string& name() const { return name_; }
  void call(const std::string& name) { name_ = name; }
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
  HandControl(const LoadedScene& scene, std::size_t robot, const std::string& link,
              InverseKinematics kinematics);

  std::size_t index_;  // of the robot in the scene
  std::shared_ptr<const Robot> robot_;
  std::string name_;
  std::string link_;
  InverseKinematics kinematics_;
  bool can_turn_ = false;
  // Any robot that nothing else moves gets a driver with the first command: one that nobody takes
  // costs nothing.
  bool is_driving_ = false;
  std::shared_ptr<RobotHand> hand_;
};

/// What users can drag a scene's robots by.
struct Hands {
  std::vector<std::unique_ptr<HandControl>> hands;
  std::vector<std::string> why_not;  ///< of each robot that has none, for users to read
};

/// The hands of all robots of a scene, of which `links` names some, "LINK" or "LINK, LINK" of
/// several robots; the others are found. Throws InputError for a link that no robot has, or for two
/// of one robot, or one that no joint moves.
Hands make_hands(LoadedScene& scene, const std::string& links);

}  // namespace pliant
