#include <ros/ros.h>

#include "pliant/math/error.h"
#include "pliant/ros/robot/keyframe_player.h"
#include "pliant/ros/running/master_watch.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "robot_player");
  ros::NodeHandle node;
  try {
    pliant::KeyframePlayer player;
    pliant::Notices notices;
    const pliant::MasterWatch watch({}, false, notices);
    player.run();
  } catch (const pliant::InputError& error) {
    ROS_FATAL("%s", error.what());
    return 2;
  }
  return 0;
}
