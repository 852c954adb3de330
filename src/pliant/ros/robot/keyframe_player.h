#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include "pliant/scene/robot/motion/keyframes.h"

namespace pliant {

/// Publishes keyframes as joint_states. With use_sim_time, keyframe time is ROS time: the positions
/// at 0 until /clock runs. Otherwise it is the time since this node started.
/// Private parameters: `keyframes` (file), `rate` (messages per second of keyframe time [Hz]).
/// Keyframes with poses are solved for the robot of the parameter `robot_description`.
class KeyframePlayer {
 public:
  /// Reads the private parameters. Throws InputError for what is wrong in them or in the file.
  KeyframePlayer();
  /// Publishes until the node is shut down.
  void run();

 private:
  double keyframe_time(const ros::Time& stamp) const;
  void publish(const ros::Time& stamp);

  ros::NodeHandle node_;
  Keyframes keyframes_;
  double period_ = 0.0;  // [s]
  ros::Time start_;
  ros::Publisher joint_states_;
  sensor_msgs::JointState message_;
};

}  // namespace pliant
