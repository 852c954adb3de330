#pragma once

#include <pliant/SolverStatus.h>
#include <ros/node_handle.h>
#include <sensor_msgs/JointState.h>

#include "pliant/core/timer.h"
#include "pliant/scene/keyframes.h"

namespace pliant {

/// Follows the simulated time of a model node through its status messages, which come less often
/// than it is asked for.
class ModelClock {
 public:
  void update(const SolverStatus& status);
  /// [s]; 0 before the first message. Goes back only when the model was reset.
  double now();

 private:
  double time_ = 0.0;     // of the last message [s]
  double factor_ = 0.0;   // real-time factor since then, as expected
  double shown_ = 0.0;    // by the last now() [s]
  Timer since_;           // the last message
};

/// Publishes keyframes as joint_states. Keyframe time is
/// - the simulated time of a model node when `status` is remapped to that node's ~status,
/// - else ROS time with use_sim_time: the first keyframe until /clock runs,
/// - else the time since this node started.
/// Private parameters: `keyframes` (file), `rate` (messages per second of keyframe time [Hz]).
class KeyframePlayer {
 public:
  /// Reads the private parameters. Throws InputError for what is wrong in them or in the file.
  KeyframePlayer();
  /// Publishes until the node is shut down.
  void run();

 private:
  double now();
  void publish(double time);

  ros::NodeHandle node_;
  Keyframes keyframes_;
  double period_ = 0.0;  // [s]
  bool follows_model_ = false;
  ros::Time start_;
  ModelClock model_clock_;
  ros::Subscriber status_;
  ros::Publisher joint_states_;
  sensor_msgs::JointState message_;
};

}  // namespace pliant
