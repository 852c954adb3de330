#include "pliant/simulator.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

const std::string kTray = std::string(PLIANT_SOURCE_DIR) + "/examples/library/tray.yaml";
const std::string kKeyframes = std::string(PLIANT_SOURCE_DIR) + "/config/scenes/demo_cloth.yaml";

/// With steps that take little time.
SimulatorOptions quick() {
  SimulatorOptions options;
  options.solver = "jacobi";
  options.solver_parameters = {{"iterations", "5"}};
  return options;
}

TEST(Simulator, TellsWhatTheSceneHas) {
  const Simulator simulator(kTray, quick());
  EXPECT_EQ(simulator.bodies(), (std::vector<std::string>{"napkin", "jelly"}));
  EXPECT_EQ(simulator.joint_names(), std::vector<std::string>{"height"});
  EXPECT_EQ(simulator.vertices("napkin").cols(), 13 * 13);
  EXPECT_EQ(simulator.triangles("napkin").cols(), 2 * 12 * 12);
  EXPECT_EQ(simulator.positions("napkin"), simulator.vertices("napkin"));
  EXPECT_EQ(simulator.field("napkin", "stretch").size(), 13 * 13);
  EXPECT_EQ(simulator.time(), 0.0);
  EXPECT_EQ(simulator.time_step(), 0.005);
  EXPECT_TRUE(simulator.warnings().empty());
}

TEST(Simulator, StepsAsManyTimesAsAsked) {
  Simulator simulator(kTray, quick());
  simulator.step(3);
  EXPECT_NEAR(simulator.time(), 0.015, 1e-12);
  EXPECT_EQ(simulator.report("napkin").solver, "jacobi");
  EXPECT_EQ(simulator.report("napkin").iterations, 5);
  simulator.step(0);
  EXPECT_NEAR(simulator.time(), 0.015, 1e-12);
  expect_refusal([&] { simulator.step(-1); }, {"count is -1", ">= 0"});
}

TEST(Simulator, TakesAnotherTimeIntegration) {
  SimulatorOptions options = quick();
  options.time_integration = "bdf2";
  Simulator simulator(kTray, options);
  simulator.step();
  EXPECT_EQ(simulator.report("napkin").time_integration, "bdf2");
  EXPECT_EQ(simulator.report("napkin").first_order, "start");
  options.time_integration = "bdf3";
  expect_refusal([&] { const Simulator other(kTray, options); }, {"did you mean 'bdf2'"});
}

TEST(Simulator, GoesBackToTheStartBitForBit) {
  Simulator simulator(kTray, quick());
  const Eigen::Matrix3Xd start = simulator.positions("jelly");
  simulator.step(5);
  EXPECT_NE(simulator.positions("jelly"), start);
  simulator.reset();
  EXPECT_EQ(simulator.positions("jelly"), start);
  EXPECT_EQ(simulator.time(), 0.0);
}

TEST(Simulator, TakesValuesInsteadOfTheScenes) {
  SimulatorOptions options = quick();
  options.time_step = 0.01;
  options.values["bodies[napkin].geometry.grid.vertices"] = "[4, 4]";
  const Simulator simulator(kTray, options);
  EXPECT_EQ(simulator.vertices("napkin").cols(), 16);
  EXPECT_EQ(simulator.time_step(), 0.01);
  options.values["bodies[napkin].material.weight"] = "1";
  expect_refusal([&] { Simulator{kTray, options}; }, {"unknown", "'weight'"});
}

TEST(Simulator, MovesTheRobotToWhereItIsTold) {
  Simulator simulator(kTray, quick());
  const auto press = [&] { return -simulator.wrenches().front().force.z(); };
  simulator.step(100);
  const double at_rest = press();
  EXPECT_EQ(simulator.wrenches().front().name, "tray");
  EXPECT_TRUE(simulator.wrenches().front().is_link);
  EXPECT_GT(at_rest, 0.5);
  // Lifted at a constant 0.1 m/s it carries the same weight; all goes up by as much.
  const double before = simulator.positions("jelly").row(2).mean();
  for (int k = 1; k <= 100; ++k) {
    simulator.set_joint_positions({{"height", 0.0005 * k}});
    simulator.step();
  }
  EXPECT_NEAR(simulator.positions("jelly").row(2).mean() - before, 0.05, 0.002);
  EXPECT_NEAR(press(), at_rest, 0.05 * at_rest);
}

TEST(Simulator, RefusesJointsThatItCannotMove) {
  Simulator simulator(kTray, quick());
  expect_refusal(
      [&] {
        simulator.set_joint_positions({{"hight", 0.1}});
      },
      {"unknown joint 'hight'", "did you mean 'height'"});
  expect_refusal(
      [&] {
        simulator.set_joint_positions({{"height", 0.6}});
      },
      {"joint 'height' is 0.6", "from 0 to 0.5"});
  expect_refusal([&] { simulator.set_joint_positions({{"height", NAN}}); }, {"joint 'height'"});
  simulator.set_joint_positions({{"height", 0.5}});

  Simulator moved(kKeyframes);
  const std::string joint = moved.joint_names().front();
  expect_refusal(
      [&] {
        moved.set_joint_positions({{joint, 0.0}});
      },
      {"keyframes", joint, "robot_follows_keyframes = false"});
  SimulatorOptions options;
  options.robot_follows_keyframes = false;
  Simulator(kKeyframes, options).set_joint_positions({{joint, 0.0}});
}

TEST(Simulator, PushesABody) {
  Simulator simulator(kTray, quick()), other(kTray, quick());
  const Eigen::Vector3d center = simulator.positions("jelly").rowwise().mean();
  simulator.apply_force("jelly", center, 1.0, {0.0, 0.2, 0.0}, -1.0);
  simulator.step(10);
  other.step(10);
  EXPECT_GT(simulator.velocities("jelly").row(1).mean(),
            other.velocities("jelly").row(1).mean() + 0.02);
  EXPECT_EQ(simulator.positions("napkin"), other.positions("napkin"));
  simulator.clear_forces();
  expect_refusal(
      [&] {
        simulator.apply_force("jely", center, 1.0, {0, 0, 1}, 0.0);
      },
      {"unknown body 'jely'", "did you mean 'jelly'"});
  expect_refusal([&] { simulator.apply_force("jelly", center, -1.0, {0, 0, 1}, 0.0); }, {"radius"});
}

TEST(Simulator, RefusesNamesThatItDoesNotKnow) {
  const Simulator simulator(kTray, quick());
  expect_refusal([&] { simulator.vertices("napkins"); }, {"unknown body", "'napkin'"});
  expect_refusal([&] { simulator.field("napkin", "strech"); },
                 {"unknown field of body 'napkin'", "did you mean 'stretch'"});
  expect_refusal([] { Simulator("nowhere.yaml"); }, {"nowhere.yaml"});
}

TEST(Simulator, SaysWhyAStepIsNotFinite) {
  SimulatorOptions options = quick();
  options.values["limits.max_speed"] = "0.01";
  Simulator simulator(kTray, options);
  try {
    simulator.step(100);
    FAIL() << "it fell slower than 0.01 m/s";
  } catch (const StepError& error) {
    EXPECT_NE(std::string(error.what()).find("vertex"), std::string::npos) << error.what();
  }
  EXPECT_LT(simulator.velocities("napkin").cwiseAbs().maxCoeff(), 0.01);
}

TEST(Simulator, TakesASceneThatIsInNoFile) {
  const std::string text =
      "time_step: 0.01\n"
      "bodies:\n"
      "  - {name: cloth, model: cloth, geometry: {grid: {size: [1, 1], vertices: [3, 3]}},\n"
      "     material: {areal_density: 0.2}}\n";
  Simulator simulator = Simulator::from_text(text, "mine");
  simulator.step();
  EXPECT_EQ(simulator.positions("cloth").cols(), 9);
  expect_refusal([&] { Simulator::from_text(text + "solver: {name: drect}\n", "mine"); },
                 {"mine:5", "did you mean 'direct'"});
  // Its relative paths begin in the folder of its name.
  const std::string included = "include: tray.yaml\ntime_step: 0.002\n";
  const std::string beside = std::string(PLIANT_SOURCE_DIR) + "/examples/library/mine.yaml";
  EXPECT_EQ(Simulator::from_text(included, beside).time_step(), 0.002);
}

TEST(Simulator, GoesOnFromASavedStateBitForBit) {
  Simulator simulator(kTray, quick()), other(kTray, quick());
  simulator.set_joint_positions({{"height", 0.002}});
  simulator.step(5);
  const Simulator::State state = simulator.save();
  EXPECT_EQ(state.time(), simulator.time());
  simulator.step(10);
  other.load(state);
  other.step(10);
  EXPECT_EQ(other.positions("jelly"), simulator.positions("jelly"));
  EXPECT_EQ(other.joint_positions(), std::vector<double>{0.002});
  SimulatorOptions options = quick();
  options.values["bodies[napkin].geometry.grid.vertices"] = "[4, 4]";
  Simulator smaller(kTray, options);
  expect_refusal([&] { smaller.load(state); }, {"saved state"});
}

TEST(Simulator, HoldsABodyAndLetsItGo) {
  Simulator simulator(kTray, quick());
  const Eigen::Vector3d corner = simulator.positions("napkin").col(0);
  EXPECT_EQ(simulator.attach("napkin", "held", corner, 0.001, "world", 1e4), 1);
  EXPECT_EQ(simulator.attachments("napkin"), std::vector<std::string>{"held"});
  for (int k = 1; k <= 40; ++k) {
    simulator.apply_force("napkin", corner, 0.03, {0.0, 0.0, 0.05}, 0.0);
    simulator.step();
  }
  EXPECT_LT((simulator.positions("napkin").col(0) - corner).norm(), 1e-3);
  simulator.detach("napkin", "held");
  EXPECT_TRUE(simulator.attachments("napkin").empty());
  expect_refusal([&] { simulator.detach("napkin", "held"); }, {"held"});
  expect_refusal([&] { simulator.detach("jelly", "held"); }, {"nothing holds body 'jelly'"});
  expect_refusal([&] { simulator.attach("napkin", "", corner, 1.0, "world", 1.0); }, {"'name'"});
  expect_refusal([&] { simulator.attach("napkin", "a", corner, -1.0, "world", 1.0); },
                 {"'radius'"});
  expect_refusal([&] { simulator.attach("napkin", "a", corner, 1.0, "tary", 1.0); }, {"'tray'"});
  expect_refusal([&] { simulator.attach("napkin", "a", corner, 1.0, "world", 0.0); },
                 {"stiffness"});
}

TEST(Simulator, TellsContactsAndWhereLinksAre) {
  Simulator simulator(kTray, quick());
  EXPECT_TRUE(simulator.contacts().empty());
  simulator.set_joint_positions({{"height", 0.01}});
  simulator.step(100);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const Simulator::Contact& contact : simulator.contacts()) {
    EXPECT_EQ(contact.other, "tray");
    EXPECT_NEAR(contact.normal.norm(), 1.0, 1e-9);
    force += contact.force;
  }
  EXPECT_NEAR(force.z(), -simulator.wrenches().front().force.z(), 1e-9);
  EXPECT_EQ(simulator.joint_positions(), std::vector<double>{0.01});
  EXPECT_EQ(simulator.joint_limits("height").upper, 0.5);
  EXPECT_NEAR(simulator.link_pose("tray").translation().z(), 0.01, 0.2);
  expect_refusal([&] { simulator.link_pose("tary"); }, {"unknown link", "'tray'"});
  expect_refusal([&] { simulator.joint_limits("hight"); }, {"unknown joint", "'height'"});
}

}  // namespace
}  // namespace pliant
