#include "pliant/scene/robot/motion/inverse_kinematics.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/expect_refusal.h"
#include "support/random.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

const Robot& own_arm() {
  static const Robot arm =
      Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/arm.urdf");
  return arm;
}

bool within_limits(const Robot& robot, const std::vector<double>& positions) {
  for (std::size_t j = 0; j < positions.size(); ++j) {
    const Robot::Limits limits = robot.limits(static_cast<int>(j));
    if (!(positions[j] >= limits.lower && positions[j] <= limits.upper)) return false;
  }
  return true;
}

/// Positions within a share of the limits.
std::vector<double> random_positions(const Robot& robot, double share, Random& random) {
  std::vector<double> positions;
  for (std::size_t j = 0; j < robot.joint_names().size(); ++j) {
    const Robot::Limits limits = robot.limits(static_cast<int>(j));
    positions.push_back(share * random(limits.lower, limits.upper));
  }
  return positions;
}

TEST(InverseKinematics, ComesBackToThePose) {
  const InverseKinematics kinematics(own_arm(), "tool");
  Random random(1);
  std::vector<double> start = own_arm().initial_positions();
  start[*own_arm().joint_index("elbow")] = 1.2;
  int reached = 0;
  for (int sample = 0; sample < 100; ++sample) {
    const Eigen::Isometry3d pose =
        own_arm().link_pose("tool", random_positions(own_arm(), 0.7, random));
    const InverseKinematics::Solution solution = kinematics.solve(pose, start);
    EXPECT_TRUE(within_limits(own_arm(), solution.positions)) << sample;
    const Eigen::Isometry3d found = own_arm().link_pose("tool", solution.positions);
    EXPECT_NEAR((found.translation() - pose.translation()).norm(), solution.distance, 1e-9);
    if (!solution.reached) continue;
    ++reached;
    EXPECT_LT((found.matrix() - pose.matrix()).norm(), 5e-6) << sample;
  }
  EXPECT_GE(reached, 99);
}

TEST(InverseKinematics, TheRobotsPlaceInTheWorldIsOfNoConcern) {
  Robot robot = Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/arm.urdf");
  robot.set_base_pose(Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  const InverseKinematics kinematics(robot, "tool");
  const std::vector<double> zero(robot.joint_names().size(), 0.0);
  EXPECT_LT((kinematics.pose(zero).translation() - Eigen::Vector3d(0, 0, 1.30)).norm(), 1e-12);
}

TEST(InverseKinematics, SameInputSameAnswer) {
  const InverseKinematics first(own_arm(), "tool"), second(own_arm(), "tool");
  Random random(2);
  const std::vector<double> start = random_positions(own_arm(), 0.5, random);
  const Eigen::Isometry3d pose =
      own_arm().link_pose("tool", random_positions(own_arm(), 0.5, random));
  const auto once = first.solve(pose, start);
  second.solve(own_arm().link_pose("tool", random_positions(own_arm(), 0.5, random)), start);
  EXPECT_EQ(second.solve(pose, start).positions, once.positions);
}

TEST(InverseKinematics, OtherJointsStayWhereTheyAre) {
  const InverseKinematics kinematics(own_arm(), "tool");
  std::vector<double> start = own_arm().initial_positions();
  const auto finger = static_cast<std::size_t>(*own_arm().joint_index("left_finger_joint"));
  start[finger] = 0.02;
  start[static_cast<std::size_t>(*own_arm().joint_index("elbow"))] = 1.0;
  Eigen::Isometry3d pose = kinematics.pose(start);
  pose.translation().x() += 0.05;
  const auto solution = kinematics.solve(pose, start);
  EXPECT_TRUE(solution.reached);
  EXPECT_EQ(solution.positions[finger], 0.02);
  EXPECT_EQ(kinematics.joints().size(), 7u);
}

TEST(InverseKinematics, ComesNearWhereItDoesNotReach) {
  const InverseKinematics kinematics(own_arm(), "tool");
  std::vector<double> start = own_arm().initial_positions();
  start[static_cast<std::size_t>(*own_arm().joint_index("elbow"))] = 1.0;
  // The shoulder is at a height of 0.31, from where the tool reaches 0.99 straight ahead.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1.29, 0, 0.31);
  const auto solution = kinematics.solve(pose, start);
  EXPECT_FALSE(solution.reached);
  EXPECT_TRUE(within_limits(own_arm(), solution.positions));
  EXPECT_NEAR(solution.distance, 0.30, 0.01);
  EXPECT_LT(solution.angle, 0.02);
}

TEST(InverseKinematics, ReachesWithOneJointWhatOneJointReaches) {
  const Robot robot = Robot::from_text(kLiftUrdf);
  const InverseKinematics kinematics(robot, "hand");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation().z() = 0.7;
  const auto reached = kinematics.solve(pose, {0.0});
  EXPECT_TRUE(reached.reached);
  EXPECT_NEAR(reached.positions[0], 0.7, 1e-7);
  pose.translation().z() = 1.25;
  const auto near = kinematics.solve(pose, {0.0});
  EXPECT_FALSE(near.reached);
  EXPECT_EQ(near.positions[0], 1.0);
  EXPECT_NEAR(near.distance, 0.25, 1e-12);
  EXPECT_EQ(near.angle, 0.0);
}

TEST(InverseKinematics, RefusesALinkBehindAFloatingJoint) {
  const Robot robot = Robot::from_text(R"(<robot name="drone">
  <link name="world"/>
  <joint name="flies" type="floating"><parent link="world"/><child link="body"/></joint>
  <link name="body"/>
  <joint name="lift" type="prismatic">
    <parent link="body"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <link name="hand"/>
</robot>)");
  expect_refusal([&] { InverseKinematics(robot, "hand"); },
                 {"link 'hand' hangs on joint 'flies', which is floating", "tf"});
}

TEST(InverseKinematics, RefusesLinksThatItCannotPlace) {
  const auto refused = [](const std::string& link, const std::vector<std::string>& parts) {
    expect_refusal([&] { InverseKinematics(own_arm(), link); }, parts);
  };
  refused("tol", {"unknown link 'tol'", "did you mean 'tool'?"});
  refused("base", {"no joint moves link 'base'"});
  refused("right_finger", {"'right_finger'", "'right_finger_joint', which mimics"});
  EXPECT_NO_THROW(InverseKinematics(own_arm(), "left_finger"));
}

}  // namespace
}  // namespace pliant
