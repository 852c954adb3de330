#include "pliant/ros/running/simulation.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/robot/scene_frames.h"
#include "pliant/ros/running/what_runs.h"
#include "pliant/ros/status_messages.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {
namespace {

/// Of a beam and a cloth that no solver moves both.
class SimulationOfTwoModels : public testing::Test {
 protected:
  SimulationOfTwoModels()
      : simulation_(load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/apart.yaml"), nullptr, {}) {}
  void refused(const std::string& solver, const std::string& body,
               const std::vector<std::string>& words) {
    try {
      simulation_.switch_solver(solver, {}, body);
      ADD_FAILURE() << solver << " was taken";
    } catch (const InputError& error) {
      for (const std::string& word : words) {
        EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
      }
    }
    EXPECT_EQ(simulation_.solvers(), "trigonometric, xpbd") << "a refusal changes nothing";
  }

  Simulation simulation_;
};

TEST_F(SimulationOfTwoModels, TakesASolverOfOneBody) {
  EXPECT_EQ(simulation_.switch_solver("newmark", {}, "beam").message,
            "newmark for 'beam' from 0 s on");
  EXPECT_EQ(simulation_.switch_solver("jacobi", {}, "cloth").message,
            "jacobi for 'cloth' from 0 s on");
  EXPECT_EQ(simulation_.solvers(), "newmark, jacobi");
  EXPECT_TRUE(simulation_.make_step());
}

// Newton moves all bodies by default: what one cannot have beside it gives way, as far as nobody
// chose it.
TEST(SimulationOfBodiesThatTouch, OneIsSwitchedAlone) {
  Simulation simulation(load_scene(PLIANT_SOURCE_DIR "/config/scenes/cloth_on_jelly.yaml"), nullptr,
                        {});
  EXPECT_EQ(simulation.solvers(), "newton");
  try {
    simulation.switch_solver("jacobi", {}, "jelly");
    ADD_FAILURE() << "jacobi was taken beside others";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("differ"), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulation.solvers(), "newton") << "a refusal changes nothing";
  EXPECT_TRUE(simulation.make_step());
  EXPECT_EQ(simulation.switch_solver("lbfgs", {}, "jelly").message,
            "lbfgs for 'jelly' from 0.005 s on; 'box' takes xpbd beside it; 'towel' takes xpbd "
            "beside it");
  EXPECT_EQ(simulation.solvers(), "lbfgs, xpbd");
  EXPECT_TRUE(simulation.make_step());
  EXPECT_EQ(simulation.switch_solver("newton", {}, "").message,
            "newton for all 3 bodies from 0.01 s on");
  EXPECT_EQ(simulation.solvers(), "newton");
  EXPECT_TRUE(simulation.make_step());
}

TEST_F(SimulationOfTwoModels, RefusesASolverThatDoesNotSuit) {
  refused("jacobi", "", {"works for 'cloth'", "not for 'beam'", "'reduced'", "name a 'body'"});
  refused("newmark", "", {"works for 'beam'", "not for 'cloth'", "name a 'body'"});
  refused("jacobi", "beam", {"'jacobi' does not work for model 'reduced'"});
  refused("jacoby", "", {"unknown solver 'jacoby'", "did you mean 'jacobi'"});
}

TEST_F(SimulationOfTwoModels, SwapsTheTimeIntegrationOfABodyThatCanHaveOthers) {
  EXPECT_EQ(simulation_.switch_solver("", {}, "cloth", "bdf2").message,
            "bdf2 for 'cloth' from 0 s on");
  EXPECT_EQ(simulation_.switch_solver("newton", {}, "cloth", "midpoint").message,
            "newton by midpoint for 'cloth' from 0 s on");
  const auto refused = [&](const std::string& solver, const std::string& body,
                           const std::string& integration, const std::string& words) {
    try {
      simulation_.switch_solver(solver, {}, body, integration);
      ADD_FAILURE() << integration << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
    EXPECT_EQ(simulation_.solvers(), "trigonometric, newton") << "a refusal changes nothing";
  };
  refused("", "", "bdf2", "works for 'cloth', but not for 'beam' of the model 'reduced'");
  refused("", "beam", "bdf2", "does not work for model 'reduced'");
  refused("", "cloth", "bdf", "did you mean 'bdf2'");
  refused("jacobi", "cloth", "bdf", "did you mean 'bdf2'");
  refused("verlet", "cloth", "", "'midpoint' is for implicit solvers");
  refused("verlet", "cloth", "bdf2", "is for implicit solvers");
  EXPECT_TRUE(simulation_.make_step());
  SolverStatus status;
  fill_status(simulation_, StepStatistics(simulation_.names().size()), status);
  for (const BodyStatus& body : status.bodies) {
    EXPECT_EQ(body.time_integration, body.name == "cloth" ? "midpoint" : "");
  }
  EXPECT_EQ(simulation_.switch_solver("verlet", {}, "cloth", "implicit_euler").message,
            "verlet by implicit_euler for 'cloth' from 0.004 s on");
}

TEST(Backend, OfAllSolversIsOverridden) {
  const std::string path = PLIANT_SOURCE_DIR "/tests/ros/scenes/hanging.yaml";
  const auto reason_for_backend = [&](const SceneOverrides& overrides) {
    const LoadedScene scene = load_scene(path, overrides);
    scene.world->step();
    return scene.world->bodies().front().report.backend_reason;
  };
  SceneOverrides overrides;
  overrides.solver = "jacobi";
  overrides.solver_parameters = {{"backend", "auto"}};
  EXPECT_NE(reason_for_backend(overrides), "") << "it had the choice";
  overrides.backend = "cpu";
  EXPECT_EQ(reason_for_backend(overrides), "") << "it had none";
  overrides = {};
  overrides.backend = "cuda";
  overrides.solver = "verlet";
  try {
    load_scene(path, overrides);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("'verlet' of body"), std::string::npos);
  }
}

TEST_F(SimulationOfTwoModels, ForcesAndAttachmentsFindTheNearest) {
  AppliedForce force;
  force.force.x() = 1.0;
  force.point = {0.0, 2.0, 0.6};
  EXPECT_NE(simulation_.apply_force(force, {}, "").message.find("on 'cloth'"), std::string::npos);
  Region region;
  region.kind = Region::Kind::kSphere;
  region.center = force.point;
  region.radius = 9.0;
  EXPECT_EQ(simulation_.attach("a", region, "world", 10.0, "").message,
            "'a' holds 25 vertices of 'cloth' to world");
  EXPECT_EQ(simulation_.clear_forces("beam").message, "0 cleared on 'beam'");
  EXPECT_EQ(simulation_.clear_forces("cloth").message, "1 cleared on 'cloth'");
}

/// Another one on what is said to be a device.
std::unique_ptr<Solver> solver_on_a_device() {
  const auto make = [] {
    const auto& entry = all_solvers().find("xpbd");
    return entry.make(parse_parameters(entry.parameters, {}, "test"));
  };
  return with_fallback(
      "cuda", make(), [make](SolverBatch*) { return make(); }, 1);
}

TEST_F(SimulationOfTwoModels, ItIsSaidWhatMovesEachBodyAndWhere) {
  const auto says = [&](const std::string& text) {
    const std::string all = what_runs(simulation_, {"/n/surface"}, "/n");
    EXPECT_NE(all.find(text), std::string::npos) << all;
  };
  says("beam: reduced, ");
  says("solver trigonometric on cpu, topics /n/beam/surface /n/beam/points");
  says("cloth: cloth, 25 vertices, solver xpbd on cpu");
  says("rosservice call /n/reset");
  ASSERT_TRUE(simulation_.make_step());
  Body& cloth = simulation_.world().bodies()[1];
  cloth.solver = solver_on_a_device();
  simulation_.world().system_changed();
  says("cloth: cloth, 25 vertices, solver xpbd on cuda");
  says("solver trigonometric on cpu");
}

/// A gripper that keyframes move, above a towel and a ball.
class SimulationOfARobot : public testing::Test {
 protected:
  SimulationOfARobot()
      : simulation_(load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/pressed.yaml"), nullptr, {}) {}
  /// World from a frame that is listed; its absence fails.
  Eigen::Isometry3d listed(SceneFrames& frames, const std::string& name) {
    std::vector<PlacedFrame> all;
    frames.list_moving(simulation_, all);
    for (const PlacedFrame& frame : all) {
      if (frame.name == name) return frame.pose;
    }
    ADD_FAILURE() << name << " is not listed";
    return Eigen::Isometry3d::Identity();
  }
  std::size_t count(SceneFrames& frames) {
    std::vector<PlacedFrame> all;
    frames.list_moving(simulation_, all);
    return all.size();
  }

  Simulation simulation_;
};

TEST_F(SimulationOfARobot, SaysWhereItsLinksAre) {
  ASSERT_TRUE(simulation_.drives_robot());
  SceneFrames frames(simulation_, "/ns/pressed", true), without(simulation_, "/ns/pressed", false);
  EXPECT_EQ(count(frames), 8u);
  EXPECT_EQ(count(without), 0u) << "somebody else says where links are";
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(simulation_.make_step());
  EXPECT_NEAR(listed(frames, "palm").translation().z(), 0.076, 1e-9);
  EXPECT_EQ(listed(frames, "gantry_base").translation().z(), 0.0);
  // Where the obstacles of the link are.
  for (const Obstacle& obstacle : simulation_.world().obstacles()) {
    if (obstacle.link != "palm") continue;
    EXPECT_TRUE(listed(frames, "palm").isApprox(own_frame(obstacle), 1e-12));
  }
}

TEST_F(SimulationOfARobot, SaysWhereObstaclesStandAndWhichMoved) {
  SceneFrames frames(simulation_, "/ns/pressed", false);
  ASSERT_EQ(frames.standing().size(), 2u);
  EXPECT_EQ(frames.standing()[0].name, "ns/pressed/table");
  EXPECT_EQ(frames.standing()[1].name, "ns/pressed/side_wall");
  EXPECT_EQ(frames.standing()[1].pose.translation().x(), 0.5);
  for (Obstacle& obstacle : simulation_.world().obstacles()) {
    if (obstacle.name == "side-wall") obstacle.pose_end.translation().x() = 0.25;
  }
  EXPECT_EQ(count(frames), 1u);
  EXPECT_EQ(listed(frames, "ns/pressed/side_wall").translation().x(), 0.25);
  // The frames that wrenches are in.
  const std::vector<Wrench> wrenches = zero_wrenches(simulation_.world().obstacles());
  std::vector<std::string> of_wrenches;
  for (const Wrench& wrench : wrenches) of_wrenches.push_back(frames.frame_of(wrench));
  EXPECT_EQ(of_wrenches,
            (std::vector<std::string>{"wrist_link", "palm", "left_finger", "right_finger",
                                      "ns/pressed/table", "ns/pressed/side_wall"}));
}

TEST_F(SimulationOfARobot, SaysWhereBodiesAreHeld) {
  SceneFrames frames(simulation_, "/pressed", false);
  const Eigen::Vector3d corner = simulation_.world().bodies()[0].particles().x.col(80);
  Region region;
  region.kind = Region::Kind::kSphere;
  region.center = corner;
  region.radius = 0.01;
  simulation_.attach("hook 1", region, "left_finger", 1e3, "towel");
  simulation_.attach("nail", region, "world", 1e3, "towel");
  EXPECT_TRUE(listed(frames, "pressed/attachments/hook_1").translation().isApprox(corner, 1e-12));
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(simulation_.make_step());
  const Eigen::Vector3d lower = corner - Eigen::Vector3d(0.0, 0.0, 0.15 - 0.076);
  EXPECT_TRUE(listed(frames, "pressed/attachments/hook_1").translation().isApprox(lower, 1e-9));
  EXPECT_TRUE(listed(frames, "pressed/attachments/nail").translation().isApprox(corner, 1e-12));
  simulation_.detach("", "");
  EXPECT_EQ(count(frames), 0u);
}

/// The entry of /diagnostics that is called so.
diagnostic_msgs::DiagnosticStatus diagnosed(const Simulation& simulation, const std::string& name) {
  std::vector<diagnostic_msgs::DiagnosticStatus> statuses;
  const StepStatistics statistics(simulation.names().size());
  fill_diagnostics(simulation, statistics, "/n", statuses);
  for (const auto& status : statuses) {
    if (status.name == name) return status;
  }
  ADD_FAILURE() << name << " is not there";
  return {};
}

/// What a paused simulation answers to three steps and to a reset.
std::vector<std::string> answers_of(LoadedScene scene) {
  NodeParameters parameters;
  parameters.paused = true;
  Simulation simulation(std::move(scene), nullptr, parameters);
  std::vector<std::string> answers;
  const auto reply = std::make_shared<std::promise<Answer>>();
  simulation.step(3, reply);
  while (simulation.next_step()) simulation.make_step();
  answers.push_back(reply->get_future().get().message);
  const auto second = std::make_shared<std::promise<Answer>>();
  simulation.reset(second);
  answers.push_back(second->get_future().get().message);
  return answers;
}

TEST(Answers, SayWhatIsOddInTheScene) {
  const auto load = [] { return load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/apart.yaml"); };
  for (const std::string& answer : answers_of(load())) {
    EXPECT_EQ(answer.find("warning"), std::string::npos) << answer;
  }
  LoadedScene odd = load();
  odd.warnings = {"the beam is odd"};
  for (const std::string& answer : answers_of(std::move(odd))) {
    EXPECT_NE(answer.find("; warning: the beam is odd"), std::string::npos) << answer;
  }
}

TEST(Diagnostics, KeepWhatIsOddInTheScene) {
  const auto load = [] { return load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/apart.yaml"); };
  const Simulation good(load(), nullptr, {});
  EXPECT_EQ(diagnosed(good, "n: scene").level, diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_EQ(diagnosed(good, "n: simulation").message, "running");
  LoadedScene odd = load();
  odd.warnings = {"the beam is odd", "the cloth is odd"};
  const Simulation simulation(std::move(odd), nullptr, {});
  for (int k = 0; k < 2; ++k) {
    const auto status = diagnosed(simulation, "n: scene");
    EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
    EXPECT_EQ(status.message, "the beam is odd; the cloth is odd");
    EXPECT_EQ(status.values.back().value, "the cloth is odd");
  }
}

TEST(Diagnostics, TellThatTheCpuMovesWhatAGpuWasAskedFor) {
  if (why_no_cuda().empty()) GTEST_SKIP() << "there is a GPU";
  SceneOverrides overrides;
  overrides.solver = "jacobi";
  overrides.solver_parameters = {{"backend", "cuda"}};
  Simulation simulation(load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/hanging.yaml", overrides),
                        nullptr, {});
  EXPECT_EQ(diagnosed(simulation, "n: scene").level, diagnostic_msgs::DiagnosticStatus::OK);
  ASSERT_TRUE(simulation.make_step());
  const auto status = diagnosed(simulation, "n: scene");
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("body 'cloth' is moved by the CPU"), std::string::npos);
  EXPECT_NE(status.message.find(why_no_cuda()), std::string::npos);
  simulation.switch_solver("jacobi", {}, "");
  ASSERT_TRUE(simulation.make_step());
  EXPECT_EQ(diagnosed(simulation, "n: scene").level, diagnostic_msgs::DiagnosticStatus::OK);
}

TEST(Diagnostics, TellWhatIsWrongAroundTheNode) {
  const Simulation simulation(load_scene(PLIANT_SOURCE_DIR "/tests/ros/scenes/apart.yaml"), nullptr,
                              {});
  EXPECT_EQ(diagnosed(simulation, "n: ROS").level, diagnostic_msgs::DiagnosticStatus::OK);
  simulation.notices().set("clock", "two of them");
  EXPECT_EQ(diagnosed(simulation, "n: ROS").level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_EQ(diagnosed(simulation, "n: ROS").message, "two of them");
}

}  // namespace
}  // namespace pliant
