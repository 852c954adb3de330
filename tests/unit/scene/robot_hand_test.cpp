#include "pliant/scene/robot/motion/robot_hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/scene/robot/motion/inverse_kinematics.h"
#include "support/expect_refusal.h"

namespace pliant::robot_hand_test {
namespace {

constexpr double kStep = 0.01;  // [s]

/// What keyframes would say: every joint at 0.01 times the time.
class Ramp final : public JointSource {
 public:
  void positions(double time, std::vector<double>& positions) override {
    std::fill(positions.begin(), positions.end(), 0.01 * time);
  }
};

std::shared_ptr<const Robot> robot_of(const std::string& file) {
  return std::make_shared<const Robot>(
      Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/" + file));
}

/// A robot's hand, and the positions that it gives step by step.
struct Driven {
  explicit Driven(const std::string& file, bool has_usual = true)
      : robot(robot_of(file)),
        link(find_hand(*robot)),
        arm(InverseKinematics(*robot, link).joints()),
        hand(robot, has_usual ? std::make_shared<Ramp>() : nullptr, find_fingers(*robot, link, arm),
             world),
        positions(robot->initial_positions()) {
    hand.positions(0.0, positions);
  }
  void step(int count = 1) {
    for (int k = 0; k < count; ++k) hand.positions(++steps * kStep, positions);
  }
  double& at(const std::string& joint) {
    return positions[static_cast<std::size_t>(*robot->joint_index(joint))];
  }

  World world{kStep};
  std::shared_ptr<const Robot> robot;
  std::string link;
  std::vector<int> arm;
  RobotHand hand;
  std::vector<double> positions;
  int steps = 0;
};

TEST(RobotTree, TheHandIsWhereTheFingersSit) {
  EXPECT_EQ(find_hand(*robot_of("arm.urdf")), "palm");
  EXPECT_EQ(find_hand(*robot_of("gripper.urdf")), "palm");
  // A finger on a gantry has no fingers of its own: the last link that moves.
  const auto finger = robot_of("finger.urdf");
  const std::string last = find_hand(*finger);
  EXPECT_FALSE(last.empty());
  EXPECT_TRUE(find_fingers(*finger, last, InverseKinematics(*finger, last).joints()).empty());
}

TEST(RobotTree, ARobotThatBranchesAtItsRootHasNoHand) {
  const std::string joint =
      "<joint name='{0}' type='revolute'><parent link='base'/><child link='{0}_link'/>"
      "<limit lower='-1' upper='1' velocity='1' effort='1'/></joint><link name='{0}_link'/>";
  std::string urdf = "<robot name='two'><link name='base'/>";
  for (const std::string name : {"left", "right"}) {
    std::string own = joint;
    for (std::size_t at; (at = own.find("{0}")) != std::string::npos;) own.replace(at, 3, name);
    urdf += own;
  }
  EXPECT_EQ(find_hand(Robot::from_text(urdf + "</robot>")), "");
  EXPECT_EQ(find_hand(Robot::from_text("<robot name='one'><link name='base'/></robot>")), "");
}

TEST(RobotTree, FingersAreOpenWhereTheyAreFarApart) {
  for (const std::string file : {"arm.urdf", "gripper.urdf"}) {
    const Driven driven(file);
    const auto fingers = find_fingers(*driven.robot, driven.link, driven.arm);
    ASSERT_EQ(fingers.size(), file == "arm.urdf" ? 1u : 2u) << file;  // one mimics the other
    for (const FingerJoint& finger : fingers) {
      EXPECT_EQ(finger.closed, 0.0) << file;
      EXPECT_EQ(finger.open, driven.robot->limits(finger.joint).upper) << file;
    }
  }
}

TEST(RobotHand, FollowsItsUsualSourceUntilItIsTaken) {
  Driven driven("gripper.urdf");
  driven.step(100);
  EXPECT_FALSE(driven.hand.is_taken());
  EXPECT_NEAR(driven.at("gantry_x"), 0.01, 1e-12);
}

TEST(RobotHand, MovesNoJointFasterThanItsUrdfAllowsAndAllArriveTogether) {
  Driven driven("arm.urdf", false);
  std::vector<double> goal = driven.positions;
  goal[0] = 1.0;
  goal[3] = -2.0;
  driven.hand.move_to(goal);
  std::vector<double> before = driven.positions;
  int moving = 0;
  while (driven.hand.is_moving() && moving < 1000) {
    driven.step();
    ++moving;
    for (std::size_t j = 0; j < goal.size(); ++j) {
      const double speed = std::abs(driven.positions[j] - before[j]) / kStep;
      EXPECT_LE(speed, driven.robot->limits(static_cast<int>(j)).velocity * (1 + 1e-12)) << j;
    }
    before = driven.positions;
    // The same share of the path.
    EXPECT_NEAR(driven.positions[0] / 1.0, driven.positions[3] / -2.0, 1e-9);
  }
  EXPECT_EQ(driven.positions, goal);
  EXPECT_NEAR(moving * kStep, 1.0, 2 * kStep);  // the elbow's 2 rad at 2 rad/s
}

TEST(RobotHand, KeyframesWaitWhileItIsTakenAndGoOnWhereTheyStopped) {
  Driven driven("gripper.urdf");
  driven.step(100);
  std::vector<double> goal = driven.positions;
  goal[0] = 0.2;
  driven.hand.move_to(goal);
  driven.step(100);
  EXPECT_NEAR(driven.at("gantry_x"), 0.2, 1e-12);
  EXPECT_NEAR(driven.at("gantry_y"), 0.01, 1e-12);
  driven.hand.give_back();
  EXPECT_TRUE(driven.hand.is_taken());
  driven.step(19);
  // On its way back at the gantry's 1 m/s: 0.19 m take 0.19 s.
  EXPECT_NEAR(driven.at("gantry_x"), 0.01, 1e-9);
  driven.step(1);
  EXPECT_FALSE(driven.hand.is_taken());
  driven.step(100);
  EXPECT_NEAR(driven.at("gantry_x"), 0.02, 2e-4);
}

TEST(RobotHand, AResetGivesItBack) {
  Driven driven("gripper.urdf");
  driven.step(10);
  driven.hand.open();
  driven.step(10);
  driven.hand.positions(0.0, driven.positions);
  EXPECT_FALSE(driven.hand.is_taken());
  EXPECT_EQ(driven.at("left_finger_joint"), 0.0);
  driven.hand.positions(1.0, driven.positions);
  EXPECT_NEAR(driven.at("gantry_x"), 0.01, 1e-12);
}

TEST(RobotHand, OpensClosesAndStops) {
  for (const std::string file : {"arm.urdf", "gripper.urdf"}) {
    Driven driven(file, false);
    driven.hand.open();
    driven.step(200);
    const double open = driven.robot->limits(*driven.robot->joint_index("left_finger_joint")).upper;
    EXPECT_EQ(driven.at("left_finger_joint"), open) << file;
    driven.hand.close(5.0);
    driven.step(2);
    driven.hand.stop();
    driven.step(50);
    EXPECT_GT(driven.at("left_finger_joint"), 0.0) << file;
    EXPECT_LT(driven.at("left_finger_joint"), open) << file;
    driven.hand.close(5.0);
    driven.step(200);
    EXPECT_EQ(driven.at("left_finger_joint"), 0.0) << file;
  }
}

TEST(RobotHand, DraggingKeepsTheFingersAsTheyAre) {
  Driven driven("gripper.urdf", false);
  driven.hand.open();
  driven.step(100);
  std::vector<double> goal(driven.positions.size(), 0.0);
  goal[0] = 0.1;
  driven.hand.move_to(goal);
  driven.step(100);
  EXPECT_GT(driven.at("left_finger_joint"), 0.03);
  EXPECT_EQ(driven.at("gantry_x"), 0.1);
}

TEST(RobotHand, RefusesWhatItCannotDo) {
  Driven finger("finger.urdf");
  expect_refusal([&] { finger.hand.open(); }, {"no fingers"});
  expect_refusal([&] { finger.hand.close(1.0); }, {"no fingers"});
  EXPECT_FALSE(finger.hand.is_taken());
  std::vector<double> bad = finger.positions;
  bad.front() = std::numeric_limits<double>::quiet_NaN();
  expect_refusal([&] { finger.hand.move_to(bad); }, {"finite"});
  expect_refusal([&] { finger.hand.move_to({}); }, {"0 joint positions"});
  EXPECT_FALSE(finger.hand.is_taken());
}

}  // namespace
}  // namespace pliant::robot_hand_test
