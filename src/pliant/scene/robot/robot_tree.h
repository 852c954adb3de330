#pragma once

#include <string>
#include <vector>

#include "pliant/scene/robot/robot.h"

namespace pliant {

/// The link that users take for a robot's hand: the one on which its fingers sit, where the chain
/// of moving links from the root on branches; without fingers the last link that a joint moves. ""
/// where the root branches already, or nothing moves.
std::string find_hand(const Robot& robot);

/// A joint of a gripper, and where it is open and closed [m or rad].
struct FingerJoint {
  int joint = 0;  ///< index in Robot::joint_names()
  double open = 0.0, closed = 0.0;
};

/// What moves the links that hang on the hand, or of the links of a robot without an arm, all that
/// moves: joints with limits that are not among `arm`. Open is where its links are farther from
/// those of the other fingers and from the hand's middle.
std::vector<FingerJoint> find_fingers(const Robot& robot, const std::string& hand,
                                      const std::vector<int>& arm);

/// Names of the links that a joint moves.
std::vector<std::string> links_moved_by(const Robot& robot, int joint);

}  // namespace pliant
