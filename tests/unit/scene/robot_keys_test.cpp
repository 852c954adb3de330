#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <set>

#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

/// An arm whose tip has only a visual shape, a finger that mimics, and a tool that tf moves.
constexpr const char* kHandUrdf = R"(<robot name="hand">
  <link name="base"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="left_tip"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>
  <link name="right_tip"><visual><geometry><sphere radius="0.02"/></geometry></visual></link>
  <joint name="left" type="prismatic">
    <parent link="base"/><child link="left_tip"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="1" velocity="0.5" effort="1"/>
  </joint>
  <joint name="right" type="prismatic">
    <parent link="base"/><child link="right_tip"/><axis xyz="-1 0 0"/>
    <limit lower="0" upper="1" velocity="0.5" effort="1"/><mimic joint="left"/>
  </joint>
</robot>
)";

constexpr const char* kBody =
    "time_step: 0.01\n"
    "bodies: [{name: towel, model: cloth, geometry: {grid: {size: [1, 1], vertices: [2, 2]}}, "
    "position: [0, 0, 9]}]\n"
    "effects: {contact: {}}\n";

/// A folder with a scene whose `robot` is what is given.
class Hand {
 public:
  Hand() { files_.write("hand.urdf", kHandUrdf); }

  std::string write(const std::string& robot) const {
    return files_.write("scene.yaml", kBody + ("robot: " + robot) + "\n");
  }
  LoadedScene load(const std::string& robot, const SceneOverrides& overrides = {}) const {
    return load_scene(write(robot), overrides);
  }
  void refuse(const std::string& robot, const std::vector<std::string>& parts) const {
    expect_refusal([&] { load(robot); }, parts);
  }
  void motion(const std::string& text) const { files_.write("motion.yaml", text); }

 private:
  SceneFiles files_;
};

std::set<std::string> links_of(const LoadedScene& scene) {
  std::set<std::string> links;
  for (const Obstacle& obstacle : scene.world->obstacles()) links.insert(obstacle.link);
  return links;
}

std::string warnings_of(const LoadedScene& scene) {
  std::string all;
  for (const std::string& warning : scene.warnings) all += warning + "\n";
  return all;
}

/// Expects that `all` holds each of `parts`.
void expect_told(const std::string& all, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(all.find(part), std::string::npos) << part << " is not in:\n" << all;
  }
}

using Links = std::set<std::string>;

TEST(RobotKeys, LinksChoosesWhatTouches) {
  const Hand hand;
  EXPECT_EQ(links_of(hand.load("{urdf: hand.urdf}")), (Links{"base", "left_tip"}));
  EXPECT_EQ(links_of(hand.load("{urdf: hand.urdf, links: {include: ['*_tip']}}")),
            (Links{"left_tip"}));
  EXPECT_EQ(links_of(hand.load("{urdf: hand.urdf, links: {exclude: [base]}}")),
            (Links{"left_tip"}));
  EXPECT_EQ(links_of(hand.load("{urdf: hand.urdf, links: {include: ['*'], exclude: ['l*']}}")),
            (Links{"base"}));
}

TEST(RobotKeys, LinksThatNoLinkMatchesAreRefused) {
  const Hand hand;
  hand.refuse("{urdf: hand.urdf, links: {include: [left_tp]}}",
              {"scene.yaml:4: robot.links", "'left_tp'", "did you mean 'left_tip'?"});
  hand.refuse("{urdf: hand.urdf, links: {exclude: ['x*']}}", {"scene.yaml:4", "'x*'"});
  hand.refuse("{urdf: hand.urdf, links: {exclude: []}}",
              {"robot.links.exclude", "a list of links"});
  hand.refuse("{urdf: hand.urdf, links: {only: [base]}}", {"unknown key 'only'", "include"});
}

TEST(RobotKeys, LinksWithoutShapeThatAreAskedForAreTold) {
  const LoadedScene scene = Hand().load("{urdf: hand.urdf, links: {include: [base, right_tip]}}");
  expect_told(warnings_of(scene), {"link 'right_tip' has no collision shape", "collision: visual"});
}

// So that a broken mesh of a link that matters not is no obstacle to the rest.
TEST(RobotKeys, MeshesOfLinksThatAreLeftOutAreNotRead) {
  const SceneFiles files;
  files.write("hand.urdf",
              replaced(kHandUrdf, "<sphere radius=\"0.1\"/>", "<mesh filename=\"none.stl\"/>"));
  const auto load = [&](const char* robot) {
    return load_scene(files.write("s.yaml", std::string(kBody) + "robot: " + robot));
  };
  expect_refusal([&] { load("{urdf: hand.urdf}"); }, {"hand.urdf:2", "none.stl"});
  EXPECT_EQ(links_of(load("{urdf: hand.urdf, links: {exclude: [base]}}")), (Links{"left_tip"}));
}

TEST(RobotKeys, VisualShapesStandInForMissingCollisionShapes) {
  const LoadedScene scene = Hand().load("{urdf: hand.urdf, collision: visual}");
  EXPECT_EQ(links_of(scene), (Links{"base", "left_tip", "right_tip"}));
  EXPECT_EQ(scene.world->obstacles()[2].name, "right_tip/visual 0");
  Hand().refuse("{urdf: hand.urdf, collision: visaul}", {"collision 'visaul'", "given, visual"});
}

TEST(RobotKeys, LinksHaveFrictionOfTheirOwn) {
  const Hand hand;
  const LoadedScene scene =
      hand.load("{urdf: hand.urdf, friction: 0.2, link_friction: {left_tip: 1.5}}");
  EXPECT_EQ(scene.world->obstacles()[0].friction, 0.2);
  EXPECT_EQ(scene.world->obstacles()[1].friction, 1.5);
  hand.refuse("{urdf: hand.urdf, link_friction: {letf_tip: 1}}",
              {"scene.yaml:4: robot.link_friction", "'letf_tip'", "did you mean 'left_tip'?"});
  hand.refuse("{urdf: hand.urdf, link_friction: {left_tip: -1}}",
              {"robot.link_friction.left_tip is -1", ">= 0"});
}

constexpr const char* kTwo =
    "[{urdf: hand.urdf, prefix: a_, initial: {left: 0.25}},\n"
    "  {urdf: hand.urdf, prefix: b_, position: [2, 0, 0], initial: {b_left: 0.5}, "
    "link_friction: {left_tip: 0.7}, links: {exclude: [base]}}]";

TEST(RobotKeys, SeveralRobotsHavePrefixes) {
  const LoadedScene scene = Hand().load(kTwo);
  EXPECT_EQ(links_of(scene), (Links{"a_base", "a_left_tip", "b_left_tip"}));
  ASSERT_EQ(scene.robots.size(), 2u);
  EXPECT_EQ(scene.robots[1].robot->joint_names(), (std::vector<std::string>{"b_left"}));
  EXPECT_FALSE(scene.robots[1].robot->joint_index("left").has_value());
  EXPECT_TRUE(
      scene.robots[1].link_pose("b_left_tip").translation().isApprox(Eigen::Vector3d(2.5, 0, 0)));
  EXPECT_EQ(scene.world->obstacles()[2].friction, 0.7);
}

TEST(RobotKeys, RobotsThatShareNamesAreRefused) {
  const Hand hand;
  hand.refuse("[{urdf: hand.urdf}, {urdf: hand.urdf}]",
              {"robot[1]", "robot[0] has a link 'base' too", "'prefix'"});
  hand.refuse("[{urdf: hand.urdf}, {urdf: none.urdf, prefix: b_}]", {"robot[1]", "none.urdf"});
  hand.refuse("[]", {"robot is an empty list", "one a robot"});
}

TEST(RobotKeys, KeyframesNameJointsWithOrWithoutPrefix) {
  const Hand hand;
  hand.motion("joints: [left]\nkeyframes: [{time: 0, positions: [0.125]}]\n");
  const LoadedScene scene = hand.load(
      "[{urdf: hand.urdf, prefix: a_, keyframes: motion.yaml}, {urdf: hand.urdf, prefix: b_}]");
  EXPECT_TRUE(
      scene.robots[0].link_pose("a_left_tip").translation().isApprox(Eigen::Vector3d(0.125, 0, 0)));
  EXPECT_TRUE(scene.robots[1].link_pose("b_left_tip").translation().isZero());
  // A mimicking joint goes with the one it follows, of the same robot.
  EXPECT_TRUE(scene.robots[0]
                  .link_pose("a_right_tip")
                  .translation()
                  .isApprox(Eigen::Vector3d(-0.125, 0, 0)));
}

TEST(RobotKeys, ADescriptionIsForTheRobotWithoutUrdf) {
  SceneOverrides overrides;
  overrides.robot_description = kLiftUrdf;
  const LoadedScene scene = Hand().load("[{urdf: hand.urdf}, {prefix: b_}]", overrides);
  EXPECT_EQ(scene.robots[0].robot->name(), "hand");
  EXPECT_EQ(scene.robots[1].robot->link_names(), (std::vector<std::string>{"b_base", "b_hand"}));
  EXPECT_EQ(warnings_of(scene).find("robot_description"), std::string::npos);
}

TEST(RobotKeys, ADescriptionThatNoRobotTakesIsTold) {
  SceneOverrides overrides;
  overrides.robot_description = kLiftUrdf;
  expect_told(warnings_of(Hand().load(kTwo, overrides)), {"'robot_description'", "not used"});
  const SceneFiles files;
  const LoadedScene none = load_scene(files.write("s.yaml", kBody), overrides);
  expect_told(warnings_of(none), {"has no 'robot'", "write 'robot: {}'", "s.yaml"});
  EXPECT_EQ(warnings_of(load_scene(files.path("s.yaml"))), "");
  // The cure that it names is one.
  const LoadedScene cured =
      load_scene(files.write("s.yaml", std::string(kBody) + "robot: {}\n"), overrides);
  EXPECT_EQ(cured.robots[0].robot->name(), "lift");
  EXPECT_EQ(warnings_of(cured), "");
}

TEST(RobotKeys, WhatNeedsTfIsToldWithoutIt) {
  const Hand hand;
  const LoadedScene scene = hand.load("{urdf: hand.urdf, base_frame: torso, position: [0, 0, 3]}");
  expect_told(warnings_of(scene), {"scene.yaml:4", "base_frame", "stays at its 'position'"});
  EXPECT_TRUE(scene.robots[0].link_pose("base").translation().isApprox(Eigen::Vector3d(0, 0, 3)));
  SceneOverrides node;
  node.knows_tf = true;
  EXPECT_EQ(warnings_of(hand.load("{urdf: hand.urdf, base_frame: torso}", node)), "");
}

constexpr const char* kFreeUrdf = R"(<robot name="free">
  <link name="world_link"/>
  <link name="cart"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="drone"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <joint name="drives" type="planar">
    <parent link="world_link"/><child link="cart"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="flies" type="floating">
    <parent link="cart"/><child link="drone"/><origin xyz="0 0 2"/>
  </joint>
</robot>
)";

TEST(RobotKeys, FloatingAndPlanarJointsStayAtTheirOriginsWithoutTf) {
  const SceneFiles files;
  files.write("free.urdf", kFreeUrdf);
  const LoadedScene scene =
      load_scene(files.write("s.yaml", std::string(kBody) + "robot: {urdf: free.urdf}\n"));
  EXPECT_TRUE(scene.robots[0].link_pose("drone").translation().isApprox(Eigen::Vector3d(1, 0, 2)));
  expect_told(warnings_of(scene), {"planar joint 'drives'", "floating joint 'flies'",
                                   "link 'drone' stays", "follows tf"});
  expect_refusal([&] { scene.robots[0].robot->find_joint("flies"); }, {"'flies' is floating"});
}

/// Puts a robot's base and free joints somewhere.
class Elsewhere final : public PlacementSource {
 public:
  void place(double time, Robot::Placement& placement) override {
    placement.world_from_base.translation().x() = time;
    placement.free[0].translation() = Eigen::Vector3d(0, time, 0);
    placement.free[1].linear() =
        Eigen::AngleAxisd(time, Eigen::Vector3d::UnitX()).toRotationMatrix();
  }
};

TEST(RobotDriver, MovesTheBaseAndFreeJoints) {
  const auto robot = std::make_shared<Robot>(Robot::from_text(kFreeUrdf));
  std::vector<Obstacle> obstacles = robot->make_obstacles();
  RobotDriver driver(robot, nullptr, std::make_shared<Elsewhere>());
  driver.drive(0.5, obstacles);
  EXPECT_TRUE(obstacles[0].pose_end.translation().isApprox(Eigen::Vector3d(0.5, 0.5, 0)));
  EXPECT_TRUE(obstacles[1].pose_end.translation().isApprox(Eigen::Vector3d(0.5, 0.5, 2)));
  EXPECT_TRUE(driver.link_pose(*robot->link_index("drone"))
                  .linear()
                  .isApprox(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix()));
}

std::string beyond_limits(const std::string& rule) {
  const Hand hand;
  hand.motion("joints: [left]\nkeyframes: [{time: 0, positions: [1.5]}]\n");
  const LoadedScene scene =
      hand.load("{urdf: hand.urdf, keyframes: motion.yaml, limits: " + rule + "}");
  const double x = scene.robots[0].link_pose("left_tip").translation().x();
  return (x > 1.0 ? "beyond; " : "within; ") + warnings_of(scene);
}

TEST(RobotKeys, LimitsSayWhatBecomesOfKeyframesBeyondThem) {
  const Hand hand;
  hand.motion("joints: [left]\nkeyframes: [{time: 0, positions: [1.5]}]\n");
  hand.refuse("{urdf: hand.urdf, keyframes: motion.yaml}",
              {"motion.yaml", "'left' at 1.5", "0 to 1", "'limits: clamp'"});
  expect_told(beyond_limits("clamp"), {"within; ", "'left'", "0 to 1", "stays within them"});
  expect_told(beyond_limits("warn"), {"beyond; ", "'left'", "goes there"});
  EXPECT_EQ(beyond_limits("ignore"), "beyond; ");
  hand.refuse("{urdf: hand.urdf, limits: clmap}", {"refuse, clamp, warn, ignore"});
}

TEST(RobotKeys, LimitsSayWhatBecomesOfInitialPositions) {
  const Hand hand;
  hand.refuse("{urdf: hand.urdf, initial: {left: 2}}", {"'left' is 2", "'limits: clamp'"});
  const auto at = [&](const std::string& rule) {
    return hand.load("{urdf: hand.urdf, initial: {left: 2}, limits: " + rule + "}")
        .robots[0]
        .robot->initial_positions()[0];
  };
  EXPECT_EQ(at("clamp"), 1.0);
  EXPECT_EQ(at("warn"), 2.0);
  hand.refuse("{urdf: hand.urdf, initial: {right: 0.1}}",
              {"'right' mimics 'left'", "name 'left' instead"});
}

TEST(RobotKeys, KeyframesFasterThanTheUrdfAllowsAreTold) {
  const Hand hand;
  const auto told = [&](const char* time) {
    hand.motion(std::string("interpolation: linear\njoints: [left]\nkeyframes: [{time: 0, "
                            "positions: [0]}, {time: ") +
                time + ", positions: [1]}]\n");
    return warnings_of(hand.load("{urdf: hand.urdf, keyframes: motion.yaml}"));
  };
  EXPECT_EQ(told("2"), "");
  expect_told(told("1"),
              {"scene.yaml:4", "joint 'left' at up to 1 m/s", "0 and 1 s", "allows 0.5 m/s"});
}

TEST(RobotKeys, JointsThatKeyframesLeaveOutAreTold) {
  const SceneFiles files;
  files.write("two.urdf", replaced(kHandUrdf, "<mimic joint=\"left\"/>", ""));
  files.write("motion.yaml", "joints: [left]\nkeyframes: [{time: 0, positions: [0]}]\n");
  const auto told = [&](const char* more) {
    return warnings_of(load_scene(files.write(
        "s.yaml",
        std::string(kBody) + "robot: {urdf: two.urdf, keyframes: motion.yaml" + more + "}\n")));
  };
  expect_told(told(""), {"s.yaml:4", "robot.initial", "joint 'right'", "stays where"});
  EXPECT_EQ(told(", initial: {right: 0}"), "");
}

/// A joint that jumps to a place at a time.
class Jump final : public JointSource {
 public:
  Jump(double time, double position) : time_(time), position_(position) {}
  void positions(double time, std::vector<double>& positions) override {
    positions[0] = time < time_ ? 0.0 : position_;
  }

 private:
  double time_, position_;
};

TEST(RobotKeys, EffortsAreThoseOfTheUrdfOrGiven) {
  const Hand hand;
  EXPECT_TRUE(std::isinf(hand.load("{urdf: hand.urdf}").robots[0].robot->effort(0)));
  EXPECT_EQ(hand.load("{urdf: hand.urdf, effort: limit}").robots[0].robot->effort(0), 1.0);
  EXPECT_EQ(hand.load("{urdf: hand.urdf, efforts: {left: 3}}").robots[0].robot->effort(0), 3.0);
  EXPECT_EQ(hand.load("{urdf: hand.urdf, effort: limit, prefix: a_, efforts: {left: 3}}")
                .robots[0]
                .robot->effort(0),
            3.0);
  hand.refuse("{urdf: hand.urdf, efforts: {left: 0}}",
              {"scene.yaml:4", "robot.efforts", "'left' is 0", "above 0"});
  hand.refuse("{urdf: hand.urdf, efforts: {right: 2}}", {"robot.efforts", "mimics 'left'"});
  hand.refuse("{urdf: hand.urdf, efforts: {lift: 2}}", {"robot.efforts", "'lift'", "left"});
  hand.refuse("{urdf: hand.urdf, effort: some}", {"effort", "some", "ignore", "limit"});
}

TEST(RobotKeys, WarnsWhereNoJointHasAnEffort) {
  const SceneFiles files;
  files.write("hand.urdf", std::regex_replace(std::string(kHandUrdf), std::regex("effort=\"1\""),
                                              "effort=\"0\""));
  const std::string scene =
      files.write("scene.yaml", kBody + std::string("robot: {urdf: hand.urdf, effort: limit}\n"));
  EXPECT_NE(warnings_of(load_scene(scene)).find("robot.effort: no joint of robot 'hand'"),
            std::string::npos);
}

std::string notes_of(double position, const RobotOptions& options = {}) {
  const auto robot = std::make_shared<Robot>(Robot::from_text(kHandUrdf, options));
  std::vector<Obstacle> obstacles = robot->make_obstacles();
  RobotDriver driver(robot, std::make_shared<Jump>(0.05, position));
  driver.watch();
  for (int step = 0; step <= 10; ++step) driver.drive(0.01 * step, obstacles);
  std::string all;
  for (const std::string& note : driver.notes()) all += note + "\n";
  return all;
}

TEST(RobotDriver, NotesJumpsAndLimitsOnce) {
  EXPECT_EQ(notes_of(0.009), "");  // 0.9 m/s: uneven messages make so much of 0.5 m/s
  expect_told(notes_of(0.5), {"joint_jump: joint 'left' moved at 50 m/s", "allows 0.5 m/s"});
  const std::string both = notes_of(1.5);
  expect_told(both, {"joint_jump", "joint_limit: joint 'left' is told to go to 1.5 m", "0 to 1",
                     "goes there"});
  EXPECT_EQ(std::count(both.begin(), both.end(), '\n'), 2);
  RobotOptions clamp;
  clamp.limit_rule = JointLimitRule::kClamp;
  expect_told(notes_of(1.5, clamp), {"joint_limit", "stays within them"});
  RobotOptions ignore;
  ignore.limit_rule = JointLimitRule::kIgnore;
  EXPECT_EQ(notes_of(1.5, ignore).find("joint_limit"), std::string::npos);
}

}  // namespace
}  // namespace pliant
