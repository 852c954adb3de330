#include "pliant/scene/robot/motion/stalling_joints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "pliant/scene/robot/motion/joint_loads.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant::stalling_joints_test {
namespace {

constexpr double kEffort = 10.0, kStep = 0.01, kVelocity = 0.5;

constexpr const char* kFingerUrdf = R"(<robot name="finger">
  <link name="base"/>
  <joint name="finger" type="prismatic">
    <parent link="base"/><child link="tip"/><axis xyz="0 0 1"/>
    <limit lower="0" upper="1" velocity="0.5" effort="10"/>
  </joint>
  <link name="tip"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
</robot>
)";

/// A joint that goes down against what presses at a position with a force [N].
class Finger {
 public:
  explicit Finger(std::function<double(double)> force) : force_(std::move(force)) {}

  /// A step; how often it was tried.
  int step(double told) {
    joints_.advance({told}, kStep, positions_);
    for (int tries = 1;; ++tries) {
      load_.force = force_(positions_[0]);
      if (!joints_.answer({load_}, tries == 5, positions_)) return tries;
    }
  }
  double position() const { return positions_[0]; }
  double force() const { return load_.force; }
  StallingJoints& joints() { return joints_; }
  void put(double position) { positions_[0] = position; }

 private:
  static Robot limited() {
    Robot robot = Robot::from_text(kFingerUrdf);
    robot.limit_efforts();
    return robot;
  }
  std::function<double(double)> force_;
  Robot robot_ = limited();
  StallingJoints joints_{robot_};
  std::vector<double> positions_ = {0.5};
  JointLoad load_;
};

/// A spring of this stiffness [N/m] under 0.4 m.
std::function<double(double)> spring(double stiffness) {
  return [stiffness](double q) { return stiffness * std::max(0.0, 0.4 - q); };
}

TEST(StallingJoints, AreThoseWithAnEffort) {
  Robot robot = Robot::from_text(kFingerUrdf);
  EXPECT_FALSE(StallingJoints(robot).any());
  EXPECT_EQ(robot.limits(0).effort, 10.0);
  robot.limit_effort("finger", 3.0);
  EXPECT_TRUE(StallingJoints(robot).any());
  EXPECT_EQ(robot.effort(0), 3.0);
  expect_refusal([&] { robot.limit_effort("finger", 0.0); }, {"'finger' is 0", "above 0"});
  expect_refusal([&] { robot.limit_effort("thumb", 1.0); }, {"'thumb'", "finger"});
}

class StallingJointsAt : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Stiffnesses, StallingJointsAt, testing::Values(20.0, 1e3, 1e5, 1e7, 1e9),
                         [](const auto& info) { return "at" + std::to_string(info.index); });

// From soft bodies to such that hardly give way, the load becomes the effort and stays it.
TEST_P(StallingJointsAt, PressWithTheirEffort) {
  Finger finger(spring(GetParam()));
  double told = 0.5;
  for (int k = 0; k < 300; ++k) {
    told = std::max(0.0, told - 0.004);
    finger.step(told);
    if (told > 0.4) {
      EXPECT_EQ(finger.position(), told);
    }
  }
  const bool yields = GetParam() * 0.4 < kEffort;
  EXPECT_NEAR(finger.force(), yields ? GetParam() * 0.4 : kEffort, 0.02 * kEffort);
  if (yields) {
    EXPECT_EQ(finger.position(), told);
  }
}

TEST_P(StallingJointsAt, AreHardlyEverOverloaded) {
  Finger finger(spring(GetParam()));
  double told = 0.5;
  for (int k = 0; k < 300; ++k) {
    told = std::max(0.0, told - 0.004);
    finger.step(told);
    EXPECT_LT(finger.force(), 1.5 * kEffort) << k;
  }
}

// A position command that closes a gripper at once. How stiff what it meets is was learned from the
// way there and forgotten again, and the joint flew open.
TEST_P(StallingJointsAt, ToldToGoFarAtOncePressWithTheirEffort) {
  Finger finger(spring(GetParam()));
  double last = 0.5;
  for (int k = 0; k < 400; ++k) {
    finger.step(0.2);
    EXPECT_LE(finger.position(), last + kVelocity * kStep) << k;
    EXPECT_LE(finger.position(), 0.5) << k;
    last = finger.position();
  }
  EXPECT_NEAR(finger.force(), std::min(kEffort, 0.2 * GetParam()), 0.02 * kEffort);
}

// When what it is told turns back, it is there again.
TEST_P(StallingJointsAt, LetGo) {
  Finger finger(spring(GetParam()));
  for (const double told : {0.45, 0.39, 0.35, 0.3, 0.3, 0.3}) finger.step(told);
  for (double told = 0.3; told < 0.6; told += 0.003) finger.step(told);
  finger.step(0.6);
  EXPECT_NEAR(finger.position(), 0.6, 1e-9);
  EXPECT_EQ(finger.force(), 0.0);
}

// What vanishes between fingers is followed, at the joint's own speed at the most.
TEST(StallingJoints, CatchUpWhenNothingPressesAnyMore) {
  double stiffness = 1e4;
  Finger finger([&](double q) { return stiffness * std::max(0.0, 0.4 - q); });
  for (int k = 0; k < 50; ++k) finger.step(0.3);
  EXPECT_NEAR(finger.position(), 0.399, 1e-4);
  stiffness = 0.0;
  double last = finger.position();
  int steps = 0;
  while (finger.position() > 0.3 && steps < 200) {
    finger.step(0.3);
    EXPECT_LE(last - finger.position(), kVelocity * kStep + 1e-12);
    last = finger.position();
    ++steps;
  }
  EXPECT_EQ(finger.position(), 0.3);
  EXPECT_LT(steps, 60);
}

// One that stands still gives way to another that presses on it.
TEST(StallingJoints, GiveWayToWhatPushesThem) {
  double pushed = 0.0;
  Finger finger([&](double q) { return 1e4 * std::max(0.0, 0.5 + pushed - q); });
  for (int k = 0; k < 100; ++k) {
    pushed = 1e-3 * k;
    finger.step(0.5);
  }
  EXPECT_NEAR(finger.position(), 0.5 + pushed - kEffort / 1e4, 1e-3);
  EXPECT_LT(finger.force(), 1.5 * kEffort);
  // But not beyond the end of its way.
  for (int k = 0; k < 200; ++k) {
    pushed += 0.01;
    finger.step(0.5);
  }
  EXPECT_NEAR(finger.position(), 1.0, 1e-6);
}

TEST(StallingJoints, StandWhereThereIsNoRoom) {
  Robot robot = Robot::from_text(kFingerUrdf);
  robot.limit_efforts();
  StallingJoints joints(robot);
  std::vector<double> positions = {0.5};
  // Hardly a force, but something rigid below 0.4.
  const auto load = [](double q) {
    JointLoad load;
    const double depth = std::max(0.0, 0.4 - q);
    load.force = depth > 0.0 ? 1.0 : 0.0;
    if (depth > 0.0) load.room = 5e-4 - depth;
    load.is_crushed = depth > 8e-4;
    return load;
  };
  double told = 0.5;
  for (int k = 0; k < 200; ++k) {
    told = std::max(0.0, told - 0.004);
    joints.advance({told}, kStep, positions);
    for (int tries = 1; joints.answer({load(positions[0])}, tries == 5, positions); ++tries) {
    }
    EXPECT_GT(positions[0], 0.4 - 8.1e-4);
  }
  EXPECT_NEAR(positions[0], 0.4 - 5e-4, 1e-5);
  std::vector<std::string> notes;
  joints.note_first(notes);
  joints.note_first(notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("'finger'"), std::string::npos);
  EXPECT_NE(notes[0].find("no room"), std::string::npos);
}

// It is said as long as it holds, and as often as it begins again.
TEST(StallingJoints, NothingIsSaidOfAJointThatCaughtUp) {
  Finger finger(spring(1e5));
  const auto said = [&] {
    std::vector<std::string> notes;
    finger.joints().note_present(notes);
    return notes.size();
  };
  EXPECT_EQ(said(), 0u);
  for (int times = 0; times < 2; ++times) {
    for (int k = 0; k < 60; ++k) finger.step(0.38);
    EXPECT_EQ(said(), 1u);
    for (int k = 0; k < 60; ++k) finger.step(0.45);
    EXPECT_EQ(said(), 0u);
  }
}

// A state that was saved goes on as what was not interrupted.
TEST(StallingJoints, GoOnFromASavedState) {
  Finger one(spring(1e5)), other(spring(1e5));
  for (int k = 0; k < 40; ++k) one.step(0.39);
  StateArchive numbers;
  one.joints().save(numbers);
  other.put(one.position());
  other.joints().load(numbers);
  for (int k = 0; k < 20; ++k) {
    one.step(0.38);
    other.step(0.38);
    EXPECT_EQ(one.position(), other.position());
  }
  // Numbers that are none are not believed.
  StateArchive damaged;
  for (int k = 0; k < 5; ++k) damaged.write(std::nan(""));
  other.joints().load(damaged);
  other.step(0.7);
  EXPECT_EQ(other.position(), 0.7);
}

constexpr const char* kArmUrdf = R"(<robot name="arm">
  <link name="base"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="5"/>
  </joint>
  <link name="arm"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="out" type="prismatic">
    <parent link="arm"/><child link="tip"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="1" effort="5"/>
  </joint>
  <link name="tip"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <joint name="other" type="prismatic">
    <parent link="arm"/><child link="other_tip"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="1" effort="5"/><mimic joint="out" multiplier="-2"/>
  </joint>
  <link name="other_tip"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
</robot>
)";

/// The arm at some positions, and reactions on its links.
class ArmLoads : public testing::Test {
 protected:
  ArmLoads() {
    robot.limit_efforts();
    obstacles = robot.make_obstacles();
    reactions.resize(obstacles.size());
    move({0.4, 0.2});
  }
  void move(const std::vector<double>& positions) {
    robot.link_poses(positions, poses);
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
      links.resize(obstacles.size());
      links[o] = *robot.link_index(obstacles[o].link);
      obstacles[o].pose_end =
          poses[static_cast<std::size_t>(links[o])] * obstacles[o].link_from_shape;
    }
  }
  std::vector<JointLoad> find() {
    return JointLoads(robot).find(poses, links, obstacles, reactions);
  }

  Robot robot = Robot::from_text(kArmUrdf);
  std::vector<Obstacle> obstacles;  // arm, tip, other_tip
  std::vector<Reaction> reactions;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<int> links;
};

// The work of the forces on a small move of each joint, by differences.
TEST_F(ArmLoads, AreTheWorkOfForcesOverTheJointsMoves) {
  for (std::size_t o = 0; o < reactions.size(); ++o) {
    reactions[o].force = Eigen::Vector3d(1.0 + static_cast<double>(o), -2.0, 0.5);
    reactions[o].torque = Eigen::Vector3d(0.3, 0.1, -0.2 * static_cast<double>(o));
  }
  const std::vector<JointLoad> loads = find();
  constexpr double kMove = 1e-6;
  for (std::size_t j = 0; j < 2; ++j) {
    std::vector<double> moved = {0.4, 0.2};
    moved[j] += kMove;
    const std::vector<Obstacle> before = obstacles;
    move(moved);
    double work = 0.0;
    for (std::size_t o = 0; o < obstacles.size(); ++o) {
      const Eigen::Isometry3d &from = before[o].pose_end, &to = obstacles[o].pose_end;
      const Eigen::AngleAxisd turn(to.rotation() * from.rotation().transpose());
      work += reactions[o].force.dot(to.translation() - from.translation()) +
              reactions[o].torque.dot(turn.angle() * turn.axis());
    }
    EXPECT_NEAR(loads[j].force, work / kMove, 1e-4) << j;
    move({0.4, 0.2});
  }
}

// The joint that is nearest to its effort makes room, and no other one.
TEST_F(ArmLoads, TellWhichJointHasNoRoom) {
  move({0.0, 0.2});
  std::size_t tip = 0;
  while (obstacles[tip].link != "tip") ++tip;
  reactions[tip].force = Eigen::Vector3d(-2.0, 0.0, 0.0);
  reactions[tip].overlap = {0.9e-3, 1e-3, obstacles[tip].pose_end.translation(),
                            Eigen::Vector3d::UnitX()};
  std::vector<JointLoad> loads = find();
  EXPECT_TRUE(std::isinf(loads[0].room));
  EXPECT_NEAR(loads[1].room, -0.4e-3, 1e-12);
  EXPECT_TRUE(loads[1].is_crushed);
  // Across, the arm has to turn.
  reactions[tip].force = Eigen::Vector3d(0.0, -2.0, 0.0);
  reactions[tip].overlap.depth = 0.3e-3;
  reactions[tip].overlap.normal = Eigen::Vector3d::UnitY();
  loads = find();
  EXPECT_NEAR(loads[0].room, 0.2e-3 / 0.7, 1e-12);
  EXPECT_FALSE(loads[0].is_crushed);
  EXPECT_TRUE(std::isinf(loads[1].room));
}

}  // namespace
}  // namespace pliant::stalling_joints_test
