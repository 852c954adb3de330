#include "pliant/ros/robot/keyframe_player.h"

#include <ros/ros.h>

#include "pliant/core/step/timer.h"
#include "pliant/math/error.h"
#include "pliant/ros/node_parameters.h"
#include "pliant/scene/robot/motion/keyframe_file.h"

namespace pliant {
namespace {

constexpr double kPollPeriod = 0.002;  // wall time [s]
constexpr double kIdlePeriod = 0.1;    // between messages while time stands still; wall time [s]

const std::vector<ParameterSpec>& player_parameter_specs() {
  static const std::vector<ParameterSpec> specs = {
      choice_parameter("keyframes", "", {}, "file of the keyframes"),
      positive_parameter("rate", "Hz", "50", 1000.0, "messages per second of keyframe time"),
  };
  return specs;
}

Parameters player_parameters() {
  return read_private_parameters(ros::NodeHandle("~"), player_parameter_specs());
}

/// Of the node's namespace or one above it. Meshes are of no concern here, and are not read.
Robot described_robot(const std::string& keyframes) {
  const ros::NodeHandle node;
  std::string key, text;
  if (!node.searchParam("robot_description", key) || !node.getParam(key, text)) {
    throw InputError(keyframes +
                     ": it has poses, for which the robot has to be known: give the parameter "
                     "'robot_description', the text of its URDF");
  }
  return Robot::kinematics_from_text(text, key);
}

Keyframes read_for_robot(const std::string& path) {
  const KeyframeFile file = read_keyframe_file(path);
  if (!file.has_poses()) return make_keyframes(file, nullptr);
  const Robot robot = described_robot(path);
  return make_keyframes(file, &robot);
}

}  // namespace

KeyframePlayer::KeyframePlayer()
    : keyframes_(read_for_robot(player_parameters().text("keyframes"))),
      period_(1.0 / player_parameters().number("rate")),
      start_(ros::Time::now()),
      joint_states_(node_.advertise<sensor_msgs::JointState>("joint_states", 10)) {
  message_.name = keyframes_.joints();
  message_.position.resize(message_.name.size());
}

double KeyframePlayer::keyframe_time(const ros::Time& stamp) const {
  return ros::Time::isSimTime() ? stamp.toSec() : (stamp - start_).toSec();
}

/// Positions and stamp are of the same time, however late the message comes.
void KeyframePlayer::publish(const ros::Time& stamp) {
  const double time = keyframe_time(stamp);
  message_.header.stamp = stamp;
  for (std::size_t j = 0; j < message_.position.size(); ++j) {
    message_.position[j] = keyframes_.position(static_cast<int>(j), time);
  }
  joint_states_.publish(message_);
}

void KeyframePlayer::run() {
  double last_time = -1.0;
  Timer idle;
  while (ros::ok()) {
    // In wall time: ROS time may stand still or fly.
    ros::WallDuration(kPollPeriod).sleep();
    ros::spinOnce();
    const ros::Time stamp = ros::Time::now();
    const double time = keyframe_time(stamp);
    const bool goes_on = time < last_time || time >= last_time + period_;
    if (!goes_on && idle.seconds() < kIdlePeriod) continue;
    publish(stamp);
    last_time = time;
    idle = Timer();
  }
}

}  // namespace pliant
