#include "pliant/scene/robot/robot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

Robot gripper() {
  return Robot::from_file(std::string(PLIANT_SOURCE_DIR) + "/config/robots/gripper.urdf");
}

/// Positions of the gripper's joints by their names.
std::vector<double> positions(const Robot& robot, double x, double y, double z, double wrist,
                              double left, double right) {
  std::vector<double> all(robot.joint_names().size(), 0.0);
  robot.set_positions(
      {"gantry_x", "gantry_y", "gantry_z", "wrist", "left_finger_joint", "right_finger_joint"},
      {x, y, z, wrist, left, right}, all);
  return all;
}

TEST(Robot, KnowsTheGrippersJointsAndLinks) {
  const Robot robot = gripper();
  EXPECT_EQ(robot.name(), "gripper");
  EXPECT_EQ(robot.joint_names().size(), 6u);
  EXPECT_EQ(robot.link_names().size(), 8u);
  EXPECT_EQ(robot.link_names()[0], "gantry_base");
  EXPECT_FALSE(robot.joint_index("palm_joint").has_value());
  const int z = *robot.joint_index("gantry_z");
  EXPECT_EQ(robot.limits(z).lower, 0.0);
  EXPECT_EQ(robot.limits(z).upper, 0.30);
}

TEST(Robot, GrippersPosesAreThoseComputedByHand) {
  const Robot robot = gripper();
  const double quarter = 0.5 * M_PI;
  const auto at = positions(robot, 0.1, -0.2, 0.15, quarter, 0.03, 0.02);
  const auto origin = [&](const char* link) -> Vector3d {
    return robot.link_pose(link, at).translation();
  };
  EXPECT_TRUE(origin("gantry_base").isZero());
  EXPECT_TRUE(origin("bridge").isApprox(Vector3d(0.1, 0, 0)));
  EXPECT_TRUE(origin("carriage").isApprox(Vector3d(0.1, -0.2, 0)));
  EXPECT_TRUE(origin("column").isApprox(Vector3d(0.1, -0.2, 0.15)));
  EXPECT_TRUE(origin("palm").isApprox(Vector3d(0.1, -0.2, 0.15)));
  // The wrist turned x to y: the left finger is at +y of the tool point, the right one at -y.
  EXPECT_TRUE(origin("left_finger").isApprox(Vector3d(0.1, -0.2 + 0.03, 0.15), 1e-12));
  EXPECT_TRUE(origin("right_finger").isApprox(Vector3d(0.1, -0.2 - 0.02, 0.15), 1e-12));
  const Eigen::Matrix3d turned = robot.link_pose("left_finger", at).linear();
  EXPECT_TRUE((turned * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-12));
}

TEST(Robot, BasePoseMovesAllLinks) {
  Robot robot = gripper();
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  base.translation() = Vector3d(1, 2, 3);
  base.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitZ()).toRotationMatrix();
  robot.set_base_pose(base);
  const auto at = positions(robot, 0.1, 0, 0, 0, 0, 0);
  EXPECT_TRUE(robot.link_pose("palm", at).translation().isApprox(Vector3d(0.9, 2, 3), 1e-12));
}

TEST(Robot, CollisionShapesBecomeObstacles) {
  Robot robot = gripper();
  robot.set_initial_position("gantry_z", 0.1);
  const std::vector<Obstacle> obstacles = robot.make_obstacles();
  ASSERT_EQ(obstacles.size(), 4u);
  for (const Obstacle& obstacle : obstacles) {
    EXPECT_EQ(obstacle.name, obstacle.link + "/collision 0");
    EXPECT_TRUE(obstacle.pose_start.isApprox(obstacle.pose_end));
    if (obstacle.link != "palm") continue;
    EXPECT_EQ(obstacle.shape->name(), "box");
    EXPECT_TRUE(obstacle.link_from_shape.translation().isApprox(Vector3d(0, 0, 0.095)));
    EXPECT_TRUE(obstacle.pose_end.translation().isApprox(Vector3d(0, 0, 0.195)));
  }
}

constexpr const char* kArm = R"(<robot name="arm">
  <link name="base"/>
  <joint name="a" type="revolute">
    <parent link="base"/><child link="upper"/>
    <origin xyz="0 0 1" rpy="0 0 0"/><axis xyz="0 1 0"/>
    <limit lower="0.5" upper="2" velocity="1" effort="1"/>
  </joint>
  <link name="upper"/>
  <joint name="b" type="continuous">
    <parent link="upper"/><child link="lower"/>
    <origin xyz="1 0 0" rpy="0 0 0"/><axis xyz="0 2 0"/>
    <mimic joint="a" multiplier="-2" offset="0.5"/>
  </joint>
  <link name="lower"/>
  <joint name="c" type="revolute">
    <parent link="lower"/><child link="tip"/>
    <origin xyz="1 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-9" upper="9" velocity="1" effort="1"/>
    <mimic joint="b" multiplier="0.5"/>
  </joint>
  <link name="tip">
    <collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.1"/></geometry></collision>
    <collision><geometry><cylinder radius="0.1" length="1"/></geometry></collision>
  </link>
</robot>)";

TEST(Robot, LinksHaveTheColoursOfTheirVisualShapes) {
  const std::string ball = "<geometry><sphere radius='1'/></geometry>";
  const std::string touches = "<collision>" + ball + "</collision>";
  const auto looks = [&](const std::string& material) {
    return "<visual>" + ball + material + "</visual>";
  };
  const std::string red = "<material name='red'><color rgba='1 0 0 0.5'/></material>";
  const auto color = [&](const std::string& link) {
    const std::string urdf =
        "<robot name='r'>" + red + "<link name='l'>" + link + touches + "</link></robot>";
    return Robot::from_text(urdf).make_obstacles().at(0).color;
  };
  EXPECT_EQ(color(looks("<material name='red'/>")), Eigen::Vector4f(1.0f, 0.0f, 0.0f, 0.5f));
  EXPECT_EQ(color(looks("") + looks("<material name='g'><color rgba='0 1 0 1'/></material>")),
            Eigen::Vector4f(0.0f, 1.0f, 0.0f, 1.0f));
  EXPECT_EQ(color(looks("<material name='t'><texture filename='t.png'/></material>")),
            Obstacle().color);
  EXPECT_EQ(color(""), Obstacle().color);
}

TEST(Robot, MimicsFollowThroughChains) {
  const Robot robot = Robot::from_text(kArm);
  EXPECT_EQ(robot.joint_names(), (std::vector<std::string>{"a"}));
  EXPECT_EQ(robot.initial_positions()[0], 0.5);  // the limit next to 0
  const double a = 0.7, b = -2 * a + 0.5, c = 0.5 * b;
  // Turning about y by t takes x to (cos t, 0, -sin t).
  const auto arm = [](double t) { return Vector3d(std::cos(t), 0, -std::sin(t)); };
  const Eigen::Isometry3d tip = robot.link_pose("tip", {a});
  EXPECT_TRUE(tip.translation().isApprox(Vector3d(0, 0, 1) + arm(a) + arm(a + b), 1e-12));
  EXPECT_TRUE((tip.linear() * Vector3d::UnitX()).isApprox(arm(a + b + c), 1e-12));
}

TEST(Robot, NamesEachCollisionOfALink) {
  const std::vector<Obstacle> obstacles = Robot::from_text(kArm).make_obstacles();
  ASSERT_EQ(obstacles.size(), 2u);
  EXPECT_EQ(obstacles[0].name, "tip/collision 0");
  EXPECT_EQ(obstacles[0].shape->name(), "sphere");
  EXPECT_EQ(obstacles[1].name, "tip/collision 1");
  EXPECT_EQ(obstacles[1].shape->name(), "cylinder");
}

TEST(Robot, SetPositionsTakesWhatItKnows) {
  const Robot robot = Robot::from_text(kArm);
  std::vector<double> at = {0.0};
  std::vector<std::string> unknown;
  robot.set_positions({"b", "wheel", "a", "wheel"}, {7, 8, 1.5, 9}, at, &unknown);
  EXPECT_EQ(at[0], 1.5);
  EXPECT_EQ(unknown, (std::vector<std::string>{"wheel"}));  // "b" mimics, and is no news
  robot.set_positions({"wheel"}, {1}, at, &unknown);
  EXPECT_EQ(unknown.size(), 1u);
}

TEST(Robot, SetPositionsRefusesAndThenChangesNothing) {
  const Robot robot = Robot::from_text(kArm);
  std::vector<double> at = {0.25};
  for (double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { robot.set_positions({"a", "a"}, {1.0, bad}, at); }, {"'a'", "finite"});
  }
  expect_refusal([&] { robot.set_positions({"a"}, {}, at); }, {"1 names, but 0 values"});
  EXPECT_EQ(at[0], 0.25);
}

TEST(Robot, RefusesUnknownNamesAndBadValues) {
  Robot robot = Robot::from_text(kArm);
  expect_refusal([&] { robot.link_pose("tup", {0.0}); }, {"'tup'", "did you mean 'tip'?"});
  expect_refusal([&] { robot.link_pose("tip", {}); }, {"1 names, but 0 values"});
  expect_refusal([&] { robot.link_pose("tip", {std::nan("")}); }, {"'a'", "finite"});
  expect_refusal([&] { robot.set_initial_position("x", 0.0); }, {"'x'", "a"});
  expect_refusal([&] { robot.set_initial_position("a", 0.0); }, {"'a' is 0", "0.5 to 2"});
  expect_refusal([&] { robot.set_initial_position("a", std::nan("")); }, {"'a'"});
}

TEST(Robot, ReadsMeshesWithScaleAndPackage) {
  const SceneFiles files;
  files.write("m/t.obj",
              "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const std::string urdf =
      "<robot name='r'><link name='l'><collision><geometry><mesh filename='package://p/m/t.obj' "
      "scale='2 2 2'/></geometry></collision></link></robot>";
  RobotOptions options;
  options.resolver = [&](const std::string&) { return files.path(""); };
  const std::vector<Obstacle> obstacles = Robot::from_text(urdf, options).make_obstacles();
  ASSERT_EQ(obstacles.size(), 1u);
  EXPECT_NEAR(obstacles[0].shape->bounds().sizes().x(), 2.0, 1e-6);
  const std::string path = files.write("r.urdf", replaced(urdf, "package://p/", ""));
  EXPECT_EQ(Robot::from_file(path).make_obstacles().size(), 1u);
}

class Script final : public JointSource {
 public:
  void positions(double time, std::vector<double>& positions) override { positions[0] = time; }
};

TEST(RobotDriver, MovesItsLinksOnly) {
  const auto robot = std::make_shared<Robot>(Robot::from_text(kLiftUrdf));
  std::vector<Obstacle> obstacles(1);
  for (Obstacle& obstacle : robot->make_obstacles()) obstacles.push_back(std::move(obstacle));
  RobotDriver driver(robot, std::make_shared<Script>());
  driver.drive(0.25, obstacles);
  EXPECT_TRUE(obstacles[0].pose_end.translation().isZero());
  EXPECT_DOUBLE_EQ(obstacles[1].pose_end.translation().z(), 0.25);
  EXPECT_DOUBLE_EQ(obstacles[1].pose_start.translation().z(), 0.0);
  EXPECT_EQ(driver.positions(), (std::vector<double>{0.25}));
}

TEST(RobotDriver, KeepsTheLastPositionInsteadOfNan) {
  const auto robot = std::make_shared<Robot>(Robot::from_text(kLiftUrdf));
  std::vector<Obstacle> obstacles = robot->make_obstacles();
  RobotDriver driver(robot, std::make_shared<Script>());
  driver.drive(0.5, obstacles);
  driver.drive(std::nan(""), obstacles);
  EXPECT_DOUBLE_EQ(obstacles[0].pose_end.translation().z(), 0.5);
}

}  // namespace
}  // namespace pliant
