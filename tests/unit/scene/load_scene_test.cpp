#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "pliant/effects/attachment.h"
#include "pliant/models/solver_registry.h"
#include "pliant/scene/reading/solver_choice.h"
#include "pliant/scene/scene.h"
#include "support/expect_refusal.h"
#include "unit/scene/scene_files.h"

namespace pliant {
namespace {

LoadedScene load(const std::string& text, const SceneOverrides& overrides = {}) {
  const SceneFiles files;
  return load_scene(write_scene(files, text), overrides);
}

TEST(LoadScene, BuildsTheWorldInOrder) {
  const LoadedScene scene = load(kFullScene);
  const World& world = *scene.world;
  ASSERT_EQ(world.obstacles().size(), 3u);
  EXPECT_EQ(world.obstacles()[0].name, "ground");
  EXPECT_EQ(world.obstacles()[0].friction, 0.3);
  EXPECT_EQ(world.obstacles()[2].name, "hand/collision 0");
  EXPECT_EQ(world.obstacles()[2].link, "hand");
  ASSERT_EQ(world.bodies().size(), 1u);
  const Body& body = world.bodies()[0];
  EXPECT_EQ(body.name, "towel");
  EXPECT_EQ(body.solver->name(), "xpbd");
  EXPECT_EQ(body.effects.size(), 3u);
  EXPECT_EQ(body.model->color, Eigen::Vector3f(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(world.time_step(), 0.005);
  EXPECT_TRUE(scene.warnings.empty());
  // areal density 0.2 kg/m² times 1 m x 2 m
  EXPECT_NEAR(body.particles().mass.sum(), 0.4, 1e-12);
}

std::string block_without_solver(int cells) {
  return "time_step: 0.005\nbodies:\n  - {name: block, model: patch, geometry: {block: {size: [1, "
         "1, 1], cells: [" +
         std::to_string(cells) + ", 28, 28]}}}\n";
}

TEST(LoadScene, WithoutASolverTakesTheModelsDefault) {
  const LoadedScene scene = load(block_without_solver(2));
  const auto& [name, parameters] = scene.world->bodies()[0].solver_setting;
  EXPECT_EQ(name, default_newton_of_solids().name);
  EXPECT_EQ(parameters, default_newton_of_solids().parameters);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(LoadScene, LargeBodiesWithoutASolverTakeAnotherAndSaySo) {
  const LoadedScene scene = load(block_without_solver(28));
  EXPECT_EQ(scene.world->bodies()[0].solver->name(), "chebyshev");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find(
                "more than 20000 vertices: 'chebyshev' moves it, not the default 'newton'"),
            std::string::npos)
      << scene.warnings[0];
}

std::string cloth_without_solver(int vertices) {
  return "time_step: 0.005\nbodies:\n  - {name: sheet, model: cloth, geometry: {grid: {size: [1, "
         "1], vertices: [" +
         std::to_string(vertices) + ", 150]}}}\n";
}

TEST(LoadScene, ClothWithoutASolverAsksForAnErrorUnlessItIsLarge) {
  EXPECT_TRUE(load(cloth_without_solver(10)).warnings.empty());
  const LoadedScene large = load(cloth_without_solver(150));
  EXPECT_EQ(large.world->bodies()[0].solver->name(), "xpbd");
  ASSERT_EQ(large.warnings.size(), 1u);
  EXPECT_NE(large.warnings[0].find("the same number of iterations"), std::string::npos)
      << large.warnings[0];
}

TEST(LoadScene, ClothThatNothingStopsTakesAnotherThanOneThatIsStopped) {
  const std::string free = cloth_without_solver(10);
  EXPECT_EQ(load(free).world->bodies()[0].solver->name(), "newton");
  for (const std::string effect : {"contact: {}", "self_contact: {}", "strain_limit: {max: 1.1}"}) {
    const LoadedScene scene =
        load(free + "effects: {" + effect + "}\nobstacles: [{name: floor, shape: plane}]\n");
    EXPECT_EQ(scene.world->bodies()[0].solver->name(), "xpbd") << effect;
  }
}

std::string held_cloth(int vertices, const std::string& held, const std::string& effects) {
  return "time_step: 0.005\nbodies:\n  - {name: sheet, model: cloth, geometry: {grid: {size: [1, "
         "1], "
         "vertices: [10, " +
         std::to_string(vertices) + "]}}, " + held + "}\neffects: {" + effects +
         "}\nobstacles: [{name: floor, shape: plane, position: [0, 0, -2]}]\n";
}

TEST(LoadScene, ClothThatHangsBesideObstaclesIsMovedByNewton) {
  const std::string fixed = "fixed: [{vertices: [0]}]";
  const auto attached = [](const std::string& from) {
    return "attachments: [{name: a, vertices: [0], to: world, stiffness: 100" + from + "}]";
  };
  const auto solver = [](const std::string& scene) {
    return std::string(load(scene).world->bodies()[0].solver->name());
  };
  for (const std::string effects :
       {"contact: {}", "self_contact: {}", "contact: {}, damping: {}"}) {
    EXPECT_EQ(solver(held_cloth(10, fixed, effects)), "newton") << effects;
  }
  EXPECT_EQ(solver(held_cloth(10, attached(""), "contact: {}")), "newton");
  EXPECT_EQ(solver(held_cloth(10, attached(", from: 1"), "contact: {}")), "xpbd");
  EXPECT_EQ(solver(held_cloth(301, fixed, "contact: {}")), "xpbd") << "large";
  for (const std::string effects : {"strain_limit: {max: 1.1}", "contact: {}, wetness: {}"}) {
    EXPECT_EQ(solver(held_cloth(10, fixed, effects)), "xpbd") << effects;
  }
}

TEST(LoadScene, ClothThatHangsIsLeftToAGpuThatIsAskedFor) {
  for (const std::string effects : {"gravity: {}", "contact: {}"}) {
    const std::string scene = held_cloth(10, "fixed: [{vertices: [0]}]", effects);
    for (const auto& [backend, solver] :
         {std::pair("cuda", "xpbd"), std::pair("auto", "newton"), std::pair("cpu", "newton")}) {
      const SceneFiles files;
      SceneSpec spec = read_scene(write_scene(files, scene));
      spec.backend = backend;
      EXPECT_EQ(choose_solver(spec, {&spec.bodies[0]}, {"cloth"}, 100).name, solver) << backend;
    }
  }
}

// A GPU estimates no errors.
TEST(LoadScene, ADefaultThatAGpuMayTakeAsksForNone) {
  for (const std::string backend : {"cpu", "auto"}) {
    SceneOverrides overrides;
    overrides.backend = backend;
    const LoadedScene scene = load(block_without_solver(2), overrides);
    const auto& [name, parameters] = scene.world->bodies()[0].solver_setting;
    EXPECT_EQ(name, backend == "cpu" ? "newton" : "lbfgs");
    EXPECT_EQ(parameters.count("error"), backend == "cpu" ? 1u : 0u);
  }
}

// Which has no form of newton.
TEST(LoadScene, AGpuMayTakeARigidBody) {
  SceneOverrides overrides;
  overrides.backend = "auto";
  const LoadedScene scene = load(
      "time_step: 0.005\nbodies: [{name: box, model: rigid, geometry: {box: {size: [1, 1, "
      "1]}}}]\n",
      overrides);
  EXPECT_EQ(scene.world->bodies()[0].solver->name(), "xpbd");
}

// Those of the solver that moves the scene's body.
TEST(LoadScene, GivenParametersAreTheDefaultSolvers) {
  SceneOverrides overrides;
  overrides.solver_parameters = {{"linear_tolerance", "0.01"}};
  const LoadedScene scene = load(block_without_solver(2), overrides);
  const auto& [name, parameters] = scene.world->bodies()[0].solver_setting;
  EXPECT_EQ(name, "newton");
  EXPECT_EQ(parameters, (ParameterText{{"linear_tolerance", "0.01"}}));
}

// Iterations that are given stay what they are.
TEST(LoadScene, GivenParametersStandWithoutThoseOfTheDefault) {
  SceneSpec spec;
  spec.solver = {"xpbd", default_solver("cloth").parameters, "test"};
  spec.names_solver = false;
  spec.time_step = 0.005;
  SceneOverrides overrides;
  overrides.solver_parameters = {{"iterations", "50"}};
  apply_overrides(overrides, spec);
  EXPECT_EQ(spec.solver.parameters, (ParameterText{{"iterations", "50"}}));
}

TEST(LoadScene, PlacesFixesAndMovesBodies) {
  const LoadedScene scene = load(replaced(
      replaced(kFullScene, "rotation_rpy: [0, 0, 0]", "rotation_rpy: [0, 0, 1.5707963267948966]"),
      "velocity: [0, 0, 0]", "velocity: [1, 2, 3]"));
  const Particles& particles = scene.world->bodies()[0].particles();
  // The lower left corner (-0.5, -1) turns to (1, -0.5).
  EXPECT_TRUE(particles.x.col(0).isApprox(Eigen::Vector3d(1, -0.5, 1), 1e-12));
  EXPECT_TRUE(particles.is_fixed(0));
  EXPECT_EQ(particles.v.col(0), Eigen::Vector3d::Zero());
  for (int i = 1; i < particles.size(); ++i) {
    EXPECT_FALSE(particles.is_fixed(i));
    EXPECT_EQ(particles.v.col(i), Eigen::Vector3d(1, 2, 3));
  }
}

TEST(LoadScene, FixesTheNamedCorners) {
  const std::vector<std::pair<std::string, Eigen::Vector3d>> corners = {
      {"lower_left", {-0.5, -1, 1}},
      {"lower_right", {0.5, -1, 1}},
      {"upper_left", {-0.5, 1, 1}},
      {"upper_right", {0.5, 1, 1}}};
  for (const auto& [name, at] : corners) {
    const LoadedScene scene = load(replaced(kFullScene, "lower_left", name));
    const Particles& particles = scene.world->bodies()[0].particles();
    for (int i = 0; i < particles.size(); ++i) {
      EXPECT_EQ(particles.is_fixed(i), particles.x.col(i).isApprox(at)) << name << i;
    }
  }
}

TEST(LoadScene, FixesVerticesInABox) {
  const LoadedScene scene = load(
      replaced(kFullScene, "{corner: lower_left}", "{box: {min: [-9, 0.99, 0], max: [9, 9, 9]}}"));
  const Particles& particles = scene.world->bodies()[0].particles();
  for (int i = 0; i < 20; ++i) EXPECT_EQ(particles.is_fixed(i), i >= 16) << i;
}

TEST(LoadScene, AttachesVerticesToTheWorldObstaclesAndLinks) {
  const LoadedScene scene = load(replaced(
      kFullScene, "fixed: [{corner: lower_left}]",
      "attachments: [{name: a, corner: lower_left, stiffness: 10}, {name: b, vertices: [1, 2], "
      "stiffness: 20, to: ball, until: 0.01}, {name: c, box: {min: [-9, 0.99, 0], max: [9, 9, 9]}, "
      "stiffness: 30, to: hand, from: 0.005}]"));
  World& world = *scene.world;
  const auto held = [&] {
    std::vector<Eigen::Vector3d> points;
    dynamic_cast<AttachmentEffect&>(*world.bodies()[0].find_effect("attachment")).add_held(points);
    return points.size();
  };
  ASSERT_TRUE(world.step());
  EXPECT_EQ(held(), 3u);
  ASSERT_TRUE(world.step());
  EXPECT_EQ(held(), 7u);
  ASSERT_TRUE(world.step());
  EXPECT_EQ(held(), 5u);
  EXPECT_GT(world.reactions()[2].force.norm(), 0.0);
}

TEST(LoadScene, ReadsMeshBodiesWithScale) {
  const SceneFiles files;
  files.write("m.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n");
  const std::string text =
      "time_step: 0.01\nsolver: {name: xpbd}\nbodies: [{name: a, model: cloth, geometry: {mesh: "
      "m.obj, scale: 0.1}, material: {areal_density: 2}}]\n";
  const LoadedScene scene = load_scene(files.write("s.yaml", text));
  EXPECT_NEAR(scene.world->bodies()[0].particles().mass.sum(), 1.0, 1e-6);
  files.write("m.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  expect_refusal([&] { load_scene(files.path("s.yaml")); }, {"s.yaml:3", "'a'", "m.obj"});
}

TEST(LoadScene, KeyframesMoveTheRobot) {
  LoadedScene scene = load(kFullScene);
  const auto height = [&] { return scene.world->obstacles()[2].pose_end.translation().z(); };
  EXPECT_DOUBLE_EQ(height(), 2.0);  // the first keyframe, not `initial`
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(scene.world->step());
  EXPECT_NEAR(height(), 2.5, 1e-9);
  scene.world->reset();
  EXPECT_DOUBLE_EQ(height(), 2.0);
}

TEST(LoadScene, RobotStandsAtItsInitialPositionsWithoutDriver) {
  SceneOverrides overrides;
  overrides.drive_robot_from_keyframes = false;
  LoadedScene scene = load(kFullScene, overrides);
  ASSERT_TRUE(scene.world->step());
  EXPECT_DOUBLE_EQ(scene.world->obstacles()[2].pose_end.translation().z(), 2.1);
}

TEST(LoadScene, LinksHaveTemperaturesOfTheirOwn) {
  const auto temperature = [](const std::string& keys) {
    return load(replaced(kFullScene, "initial: {lift: 0.1}", keys))
        .world->obstacles()[2]
        .temperature;
  };
  EXPECT_FALSE(temperature("initial: {lift: 0.1}").has_value());
  EXPECT_EQ(temperature("temperature: 350"), 350.0);
  EXPECT_EQ(temperature("temperature: 350\n  link_temperatures: {hand: 400}"), 400.0);
  EXPECT_EQ(temperature("link_temperatures: {hand: 0}"), 0.0);
}

/// Temperatures of a block of particles after half a second beside `beside`, a robot's hand or
/// another obstacle of its shape [K].
Eigen::VectorXd temperatures_beside(const std::string& beside) {
  const LoadedScene scene = load(R"(
time_step: 0.01
gravity: [0, 0, 0]
bodies:
  - name: butter
    model: viscoelastic
    geometry: {block: {size: [0.06, 0.06, 0.06]}, spacing: 0.015}
    position: [0, 0, -0.08]
    material: {density: 900, young: 4.0e+4}
effects:
  contact: {thickness: 0.003}
  heat: {initial_temperature: 290, conductivity: 100, latent_heat: 1.0e+4, convection: 0}
)" + beside + "solver: {name: jacobi, iterations: 3}\n");
  World& world = *scene.world;
  for (int k = 0; k < 50; ++k) EXPECT_TRUE(world.step()) << world.failure();
  return world.bodies()[0].model->point_fields().at("temperature");
}

TEST(LoadScene, AHotLinkMeltsWhatItTouchesAsAnObstacleDoes) {
  const std::string robot = "robot:\n  urdf: robot.urdf\n  initial: {lift: 0}\n";
  const Eigen::VectorXd hot = temperatures_beside(robot + "  link_temperatures: {hand: 420}\n");
  const Eigen::VectorXd obstacle = temperatures_beside(
      "obstacles:\n  - {name: box, shape: box, size: [0.1, 0.1, 0.1], temperature: 420}\n");
  EXPECT_EQ(hot, obstacle);
  EXPECT_GT(hot.maxCoeff(), 307.0) << "melted";
  EXPECT_GT(hot.minCoeff(), 289.0);
  EXPECT_LT(hot.minCoeff(), 291.0) << "far from it";
  const Eigen::VectorXd cold = temperatures_beside(robot);
  EXPECT_NEAR(cold.maxCoeff(), 290.0, 1e-9);
}

TEST(LoadScene, OverridesSolverStepAndRobot) {
  SceneOverrides overrides;
  overrides.solver = "jacobi";
  overrides.solver_parameters = {{"iterations", "7"}};
  overrides.time_step = 0.001;
  overrides.robot_description = replaced(kLiftUrdf, "name=\"lift\">", "name=\"other\">");
  const LoadedScene scene = load(kFullScene, overrides);
  EXPECT_EQ(scene.world->bodies()[0].solver->name(), "jacobi");
  EXPECT_EQ(scene.spec.solver.parameters, (ParameterText{{"iterations", "7"}}));
  EXPECT_EQ(scene.world->time_step(), 0.001);
  EXPECT_EQ(scene.robots[0].robot->name(), "other");
}

TEST(LoadScene, OverridesOfOneParameterKeepTheOthers) {
  SceneOverrides overrides;
  overrides.solver_parameters = {{"tolerance", "0.5"}};
  EXPECT_EQ(load(kFullScene, overrides).spec.solver.parameters,
            (ParameterText{{"iterations", "5"}, {"tolerance", "0.5"}}));
}

TEST(LoadScene, UsualThreadsAreForScenesThatNameNone) {
  const std::string scene =
      "time_step: 0.01\nbodies: [{name: a, model: cloth, geometry: {grid: {size: [1, 1], "
      "vertices: [3, 3]}}}]\n";
  SceneOverrides overrides;
  overrides.usual_threads = 2;
  load(scene, overrides);
  EXPECT_EQ(threads(), 2);
  load("threads: 4\n" + scene, overrides);
  EXPECT_EQ(threads(), 4);
  overrides.threads = 3;
  load("threads: 4\n" + scene, overrides);
  EXPECT_EQ(threads(), 3);
  set_threads(1);
  load(scene, {});
  EXPECT_EQ(threads(), 1);
}

TEST(LoadScene, RefusesBadOverrides) {
  const auto refused = [](SceneOverrides overrides, const std::vector<std::string>& parts) {
    expect_refusal([&] { load(kFullScene, overrides); }, parts);
  };
  SceneOverrides overrides;
  overrides.solver = "jacoby";
  refused(overrides, {"did you mean 'jacobi'?"});
  overrides = {};
  overrides.solver_parameters = {{"iteratons", "7"}};
  refused(overrides, {"did you mean 'iterations'?"});
  for (double step : {0.0, -1.0, 2.0, std::nan("")}) {
    overrides = {};
    overrides.time_step = step;
    refused(overrides, {"time step"});
  }
  overrides = {};
  overrides.threads = 0;
  refused(overrides, {"threads"});
  overrides = {};
  overrides.robot_description = "<robot/>";
  refused(overrides, {"robot"});
}

TEST(LoadScene, WarnsOfHeatThatNothingConducts) {
  const std::string scene =
      "time_step: 0.01\nsolver: {name: jacobi}\nbodies: [{name: a, model: viscoelastic, geometry: "
      "{block: {size: [0.1, 0.1, 0.1]}, particles: 30}, material: {melting_point: 300}}]\n";
  const LoadedScene cold = load(scene);
  ASSERT_EQ(cold.warnings.size(), 1u);
  EXPECT_NE(cold.warnings[0].find("melting_point"), std::string::npos);
  EXPECT_TRUE(load(scene + "effects: {heat: {}}\n").warnings.empty());
}

TEST(LoadScene, WarnsOfWhatIsSurelyNotMeant) {
  const LoadedScene no_contact =
      load(replaced(replaced(kFullScene, "  contact: {thickness: 0.002}\n", ""),
                    "  friction: {coefficient: 0.4}\n", ""));
  ASSERT_EQ(no_contact.warnings.size(), 1u);
  EXPECT_NE(no_contact.warnings[0].find("'contact'"), std::string::npos);
}

TEST(LoadScene, ResultsAreTheSameForTheSameFile) {
  LoadedScene a = load(kFullScene), b = load(kFullScene);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(a.world->step());
    ASSERT_TRUE(b.world->step());
  }
  EXPECT_EQ(a.world->bodies()[0].particles().x, b.world->bodies()[0].particles().x);
}

}  // namespace
}  // namespace pliant
