#include <ros/ros.h>

#include "pliant/math/error.h"
#include "pliant/ros/keyframe_player.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "robot_player");
  ros::NodeHandle node;
  try {
    pliant::KeyframePlayer().run();
  } catch (const pliant::InputError& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}
