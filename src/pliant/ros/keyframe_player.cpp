#include "pliant/ros/keyframe_player.h"

#include <ros/ros.h>

#include "pliant/core/timer.h"
#include "pliant/ros/node_parameters.h"

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

}  // namespace

KeyframePlayer::KeyframePlayer()
    : keyframes_(read_keyframes(player_parameters().text("keyframes"))),
      period_(1.0 / player_parameters().number("rate")),
      start_(ros::Time::now()),
      joint_states_(node_.advertise<sensor_msgs::JointState>("joint_states", 10)) {
  message_.name = keyframes_.joints();
  message_.position.resize(message_.name.size());
}

double KeyframePlayer::now() const {
  if (ros::Time::isSimTime()) return ros::Time::now().toSec();
  return (ros::Time::now() - start_).toSec();
}

void KeyframePlayer::publish(double time) {
  message_.header.stamp = ros::Time::now();
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
    const double time = now();
    const bool goes_on = time < last_time || time >= last_time + period_;
    if (!goes_on && idle.seconds() < kIdlePeriod) continue;
    publish(time);
    last_time = time;
    idle = Timer();
  }
}

}  // namespace pliant
