// The robots that scripts/make_arm writes.
#include <gtest/gtest.h>

#include "pliant/scene/robot/robot.h"

namespace pliant {
namespace {

Robot own_robot(const std::string& name) {
  return Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/" + name + ".urdf");
}

Eigen::Vector3d place_of(const Robot& robot, const std::string& link,
                         const std::vector<double>& positions) {
  return robot.link_pose(link, positions).translation();
}

TEST(OwnRobots, TheArmHasSevenAxesAndReaches) {
  const Robot arm = own_robot("arm");
  ASSERT_EQ(arm.joint_names().size(), 8u);
  std::vector<double> positions(8, 0.0);
  const auto index = [&](const char* joint) {
    return static_cast<std::size_t>(*arm.joint_index(joint));
  };
  positions[index("shoulder_pitch")] = 0.5 * M_PI;
  // Stretched out to the front, from the shoulder at a height of 0.31.
  EXPECT_LT((place_of(arm, "flange", positions) - Eigen::Vector3d(0.84, 0, 0.31)).norm(), 1e-12);
  positions[index("left_finger_joint")] = 0.03;
  const double gap =
      (place_of(arm, "left_finger", positions) - place_of(arm, "right_finger", positions)).norm();
  EXPECT_NEAR(gap, 0.06, 1e-12);
}

TEST(OwnRobots, TheHandClosesAboutItsToolPoint) {
  for (const char* name : {"hand", "arm_with_hand"}) {
    const Robot robot = own_robot(name);
    const bool has_arm = std::string(name) != "hand";
    EXPECT_EQ(robot.joint_names().size(), has_arm ? 14u : 7u);
    const std::vector<double> open(robot.joint_names().size(), 0.0);
    std::vector<double> closed = open;
    for (std::size_t j = 0; j < closed.size(); ++j) {
      if (robot.joint_names()[j].rfind("finger_", 0) == 0) closed[j] = 0.6;
    }
    for (const char* tip : {"finger_1_tip", "finger_2_tip", "finger_3_tip"}) {
      const auto off_axis = [&](const std::vector<double>& positions) {
        const Eigen::Isometry3d tool = robot.link_pose("tool", positions);
        return (tool.inverse() * robot.link_pose(tip, positions)).translation().head<2>().norm();
      };
      EXPECT_LT(off_axis(closed), off_axis(open) - 0.005) << name << " " << tip;
    }
  }
}

}  // namespace
}  // namespace pliant
