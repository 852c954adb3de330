#include "pliant/core/world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>

#include "pliant/core/system/body_pairs.h"
#include "pliant/core/system/near_bodies.h"
#include "pliant/models/solver_registry.h"
#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::world_test {
namespace {

ClothScene full_scene(const std::string& solver) {
  return falling_scene(solver, 0.05, {{"volume", "1e-4"}});
}

class WorldOfEverySolver : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(WorldOfEverySolver);

TEST_P(WorldOfEverySolver, ResetIsTheFirstStateBitForBit) {
  auto world = make_world(full_scene(GetParam()));
  const Particles first = particles_of(*world);
  run_for(*world, 0.15);
  const Particles once = particles_of(*world);
  ASSERT_NE(once.x, first.x);
  AppliedForce push;
  push.force = Eigen::Vector3d(0, 0, 1);
  push.duration = -1.0;
  world->applied_forces().add(push);
  run_for(*world, 0.01);
  world->reset();
  EXPECT_EQ(world->time(), 0.0);
  EXPECT_EQ(world->steps(), 0u);
  EXPECT_EQ(particles_of(*world).x, first.x);
  EXPECT_EQ(particles_of(*world).v, first.v);
  for (const Reaction& reaction : world->reactions()) EXPECT_TRUE(reaction.force.isZero(0.0));
  run_for(*world, 0.15);
  EXPECT_EQ(particles_of(*world).x, once.x);
  EXPECT_EQ(particles_of(*world).v, once.v);
}

TEST_P(WorldOfEverySolver, ARefusedSolverChangesNothing) {
  auto world = make_world(full_scene(GetParam()));
  run_for(*world, 0.02);
  auto twin = make_world(full_scene(GetParam()));
  run_for(*twin, 0.02);
  Body& body = body_of(*world);
  const Solver* before = body.solver.get();
  const auto set = [&](const std::string& name, const ParameterText& text) {
    world->set_solver(body, solver_registry(), name, text, "switch_solver");
  };
  expect_refusal([&] { set("xpdb", {}); }, {"unknown solver 'xpdb'", "did you mean 'xpbd'"});
  expect_refusal([&] { set("xpbd", {{"iterations", "-1"}}); }, {"switch_solver: 'iterations'"});
  expect_refusal([&] { set("jacobi", {{"iteratons", "3"}}); }, {"did you mean 'iterations'"});
  expect_refusal([&] { set("verlet", {{"iterations", "3"}}); }, {"unknown parameter 'iterations'"});
  EXPECT_EQ(body.solver.get(), before);
  run_for(*world, 0.02);
  run_for(*twin, 0.02);
  EXPECT_EQ(particles_of(*world).x, particles_of(*twin).x);
}

TEST_P(WorldOfEverySolver, ASwapKeepsTheState) {
  auto world = make_world(full_scene(GetParam()));
  run_for(*world, 0.03);
  const Particles before = particles_of(*world);
  const double time = world->time();
  for (const std::string& name : cloth_solvers()) {
    world->set_solver(body_of(*world), solver_registry(), name, {}, "test");
    EXPECT_EQ(particles_of(*world).x, before.x);
    EXPECT_EQ(particles_of(*world).v, before.v);
    EXPECT_EQ(world->time(), time);
    EXPECT_EQ(body_of(*world).solver->name(), name);
  }
}

TEST(World, RefusesBadTimeSteps) {
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { World world(bad); }, {"time step", "positive and finite"});
  }
}

TEST(World, RefusesAnEffectTwice) {
  auto world = make_world(full_scene("xpbd"));
  Body& body = body_of(*world);
  const std::size_t effects = body.effects.size();
  const auto add = [&](const std::string& name, const ParameterText& text) {
    world->add_effect(body, effect_registry(), name, text, "set_effect");
  };
  expect_refusal([&] { add("gravity", {}); }, {"set_effect", "'gravity'", "already"});
  expect_refusal([&] { add("gravit", {}); }, {"unknown effect", "did you mean 'gravity'"});
  EXPECT_EQ(body.effects.size(), effects);
}

TEST(World, RefusesBadEffectParameters) {
  ClothScene scene;
  auto world = make_world(scene);
  Body& body = body_of(*world);
  const auto add = [&](const std::string& name, const ParameterText& text) {
    world->add_effect(body, effect_registry(), name, text, "set_effect");
  };
  expect_refusal([&] { add("damping", {{"rate", "-1"}}); }, {"set_effect: 'rate'"});
  expect_refusal([&] { add("friction", {}); }, {"'friction' needs", "contact"});
  expect_refusal([&] { add("air", {}); }, {"'air' needs", "obstacle"});
  EXPECT_TRUE(body.effects.empty());
  EXPECT_TRUE(projective_system(*body.model).constraints.empty());
}

TEST(World, RefusesASolverThatDoesNotFitTheModel) {
  auto world = make_world(ClothScene());
  SolverRegistry registry("solver");
  registry.add({"thermal", "for another model", {}, {"heat"}, nullptr});
  const Solver* before = body_of(*world).solver.get();
  expect_refusal(
      [&] { world->set_solver(body_of(*world), registry, "thermal", {}, "switch_solver"); },
      {"solver 'thermal' does not work for model 'cloth'"});
  EXPECT_EQ(body_of(*world).solver.get(), before);
}

TEST(World, CountsTimeWithoutDrift) {
  ClothScene scene;
  scene.time_step = 1e-3;
  scene.grid = {0.1, 0.1, 2, 2};
  auto world = make_world(scene);
  for (int k = 0; k < 10000; ++k) ASSERT_TRUE(world->step());
  // Step count times step, not a sum of steps: one rounding only.
  EXPECT_EQ(world->time(), 10000 * 1e-3);
  EXPECT_EQ(world->steps(), 10000u);
}

/// Moves obstacle 0 along x at 2 m/s.
class Slider final : public ObstacleDriver {
 public:
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    obstacles[0].pose_end = at(2.0 * time, 0, 0);
  }
};

// Energy that was lost, iterations that were chosen and errors that were estimated are of the run.
TEST(World, SolversForgetTheRunOnReset) {
  ClothScene scene = full_scene("xpbd");
  scene.solver_parameters = {{"error", "0.02"}, {"iterations", "3"}};
  scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {}}};
  const auto learned_by_a_step = [](World& world) {
    EXPECT_TRUE(world.step());
    StateArchive numbers;
    body_of(world).solver->save(numbers);
    std::vector<double> values;
    while (values.size() < numbers.size()) values.push_back(numbers.read());
    return values;
  };
  const auto fresh = make_world(scene), reset = make_world(scene);
  run_for(*reset, 0.2);
  reset->reset();
  EXPECT_EQ(learned_by_a_step(*reset), learned_by_a_step(*fresh));
}

TEST(World, DriversMoveObstacles) {
  World world(0.1);
  world.add_obstacle(obstacle(Sphere(0.1)));
  world.add_driver(std::make_unique<Slider>());
  world.set_initial_state();
  ASSERT_TRUE(world.step());
  ASSERT_TRUE(world.step());
  EXPECT_NEAR(world.obstacles()[0].pose_start.translation().x(), 0.2, 1e-15);
  EXPECT_NEAR(world.obstacles()[0].pose_end.translation().x(), 0.4, 1e-15);
  world.reset();
  EXPECT_EQ(world.obstacles()[0].pose_start.translation().x(), 0.0);
  EXPECT_EQ(world.obstacles()[0].pose_end.translation().x(), 0.0);
}

TEST(World, AnEmptyWorldSteps) {
  World world(0.1);
  world.set_initial_state();
  EXPECT_TRUE(world.step());
  EXPECT_EQ(world.energies().total(), 0.0);
}

TEST(World, EnergiesAddUp) {
  ClothScene scene;
  scene.pose = at(0, 0, 2.0);
  scene.effects = {{"gravity", {}}};
  auto world = make_world(scene);
  Particles& p = particles_of(*world);
  p.v.setConstant(3.0);
  const double mass = p.mass.sum();
  EXPECT_NEAR(mass, 0.15 * 0.09, 1e-12);
  EXPECT_NEAR(world->energies().kinetic, 0.5 * mass * 27.0, 1e-12);
  EXPECT_NEAR(world->energies().potential, mass * 9.81 * 2.0, 1e-12);
  EXPECT_NEAR(world->energies().elastic, 0.0, 1e-20);
  EXPECT_NEAR(world->energies().total(), mass * (13.5 + 19.62), 1e-12);
}

TEST(World, BodiesOfAGroupShareASolverWhileTheirSettingsAreTheSame) {
  const std::string solver = "solver: {name: xpbd, iterations: 10}";
  const auto world =
      world_of(scene_text({slab("one", "cloth", 0.2, solver), slab("other", "cloth", 0.1, solver)},
                          "  body_contact: {}\n"));
  Body &one = body_named(*world, "one"), &other = body_named(*world, "other");
  ASSERT_EQ(one.group, other.group);
  EXPECT_EQ(one.solver, other.solver);
  const std::shared_ptr<Solver> before = other.solver;
  world->set_solver({&one}, all_solvers(), "xpbd", {{"iterations", "20"}}, "test");
  EXPECT_NE(one.solver, before);
  EXPECT_EQ(other.solver, before);
  world->set_solver({&other}, all_solvers(), "xpbd", {{"iterations", "20"}}, "test");
  EXPECT_EQ(one.solver, other.solver);
}

/// Sheets of 2 m x 1 m with a vertex at each corner, one above the other, at these heights.
std::deque<Body> sheets_at(const std::vector<double>& heights) {
  std::deque<Body> bodies;
  const auto& entry = model_registry().find("cloth");
  for (const double height : heights) {
    const GridOptions grid{2.0, 1.0, 2, 2};
    BodyGeometry geometry{make_grid(grid), grid};
    geometry.mesh.vertices.row(2).array() += height;
    Body& body = bodies.emplace_back();
    body.name = "sheet " + std::to_string(bodies.size());
    body.model = entry.make(parse_parameters(entry.parameters, {}, "test"), geometry);
  }
  return bodies;
}

// Four vertices on the two sides of a sheet, 4 m², are a metre apart.
TEST(NearBodies, AreThoseNoFartherApartThanTheVerticesOfASurface) {
  const BodyPairs pairs;
  EXPECT_EQ(NearBodies().find(sheets_at({0.0, 0.75}), pairs).size(), 1u);
  EXPECT_EQ(NearBodies().find(sheets_at({0.0, 1.0}), pairs).size(), 1u);
  EXPECT_TRUE(NearBodies().find(sheets_at({0.0, 1.0625}), pairs).empty());
}

TEST(Body, FindsItsEffects) {
  auto world = make_world(full_scene("xpbd"));
  EXPECT_EQ(body_of(*world).find_effect("contact")->name(), "contact");
  EXPECT_EQ(body_of(*world).find_effect("wind"), nullptr);
}

}  // namespace
}  // namespace pliant::world_test
