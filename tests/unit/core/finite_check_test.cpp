#include "pliant/core/step/finite_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "pliant/core/world.h"
#include "support/solvers/projective_model.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

const double kInf = std::numeric_limits<double>::infinity();
const double kNan = std::nan("");

Particles particles() { return Particles(Positions::Zero(3, 5), Eigen::VectorXd::Ones(5)); }

TEST(FiniteCheck, AcceptsWhatIsWithinBounds) {
  Particles p = particles();
  const FiniteCheck check;
  p.x(0, 1) = -check.max_distance;
  p.v(2, 4) = check.max_speed;
  EXPECT_FALSE(check.first_bad(p).has_value());
}

TEST(FiniteCheck, NamesTheFirstBadParticle) {
  const FiniteCheck check;
  for (const double bad : {kNan, -kNan, kInf, -kInf, 1e7, -1e7}) {
    Particles p = particles();
    p.x(1, 4) = bad;
    EXPECT_EQ(check.first_bad(p), 4);
    p.v(2, 3) = bad;
    EXPECT_EQ(check.first_bad(p), 3);
  }
}

TEST(FiniteCheck, TooFastIsBad) {
  Particles p = particles();
  p.v(0, 2) = -1.0001e4;
  EXPECT_EQ(FiniteCheck().first_bad(p), 2);
}

TEST(FiniteCheck, NamesTheOneThatBeganBad) {
  const FiniteCheck check;
  for (const double bad : {kNan, kInf, -kInf}) {
    for (const bool position : {true, false}) {
      Particles p = particles();
      (position ? p.x_start : p.v_start)(2, 3) = bad;
      // The end decides: a state that a step left finite is kept.
      EXPECT_FALSE(check.first_bad(p).has_value());
      p.x.setConstant(kNan);
      EXPECT_EQ(check.first_bad(p), 3);
      const std::string message = check.message(p, 3, "towel", "xpbd", 0.5, 0.01);
      for (const char* part :
           {"'towel'", "vertex 3:", "was not finite when the step began", "0.500000 s", "undone"}) {
        EXPECT_NE(message.find(part), std::string::npos) << message;
      }
      EXPECT_EQ(message.find("smaller"), std::string::npos) << message;
      EXPECT_EQ(check.message(p, 2, "towel", "xpbd", 0.5, 0.01).find("when the step began"),
                std::string::npos);
    }
  }
}

TEST(FiniteCheck, NoParticlesAreGood) {
  EXPECT_FALSE(FiniteCheck().first_bad(Particles(Positions(3, 0), Eigen::VectorXd(0))));
}

/// Puts a force on vertex 17 in step `step`.
class Fault final : public Effect {
 public:
  Fault(double force, std::uint64_t step) : force_(force), step_(step) {}
  std::string_view name() const override { return "fault"; }
  void before_step(Body& body, double) override {
    if (body.report.step != step_) return;
    auto& system = projective_system(*body.model);
    system.external_forces(1, 17) += force_;
  }
  void repair() { force_ = 0.0; }

 private:
  double force_;
  std::uint64_t step_;
};

class RollBack : public testing::TestWithParam<std::tuple<std::string, double>> {};

TEST_P(RollBack, KeepsTheLastGoodStateAndGoesOn) {
  const auto [solver, force] = GetParam();
  ClothScene scene;
  scene.solver = solver;
  scene.time_step = 1e-3;
  scene.material = soft_material();
  scene.fixed = {0, 6};
  scene.effects = {{"gravity", {}}, {"damping", {}}};
  auto world = make_world(scene);
  auto untouched = make_world(scene);
  Body& body = body_of(*world);
  body.effects.push_back(std::make_unique<Fault>(force, 4));
  for (int k = 0; k < 3; ++k) ASSERT_TRUE(world->step());
  const Particles good = body.particles();
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_FALSE(world->step());
    EXPECT_EQ(body.particles().x, good.x);
    EXPECT_EQ(body.particles().v, good.v);
    EXPECT_EQ(world->steps(), 3u);
    EXPECT_EQ(world->time(), 3 * scene.time_step);
  }
  for (const char* part : {"'cloth'", "vertex ", "0.004000 s", "undone", "smaller than 0.001 s",
                           "more iterations", solver.c_str()}) {
    EXPECT_NE(body.report.failure.find(part), std::string::npos) << body.report.failure;
  }
  dynamic_cast<Fault&>(*body.effects.back()).repair();
  for (int k = 0; k < 5; ++k) ASSERT_TRUE(world->step());
  EXPECT_TRUE(body.report.failure.empty());
  for (int k = 0; k < 8; ++k) ASSERT_TRUE(untouched->step());
  EXPECT_EQ(body.particles().x, particles_of(*untouched).x);
  EXPECT_EQ(body.particles().v, particles_of(*untouched).v);
}

INSTANTIATE_TEST_SUITE_P(Faults, RollBack,
                         testing::Combine(testing::ValuesIn(cloth_solvers()),
                                          testing::Values(kNan, kInf, -kInf, 1e9)));

TEST(RollBackDetails, VerletNamesTheVertexItself) {
  ClothScene scene;
  scene.solver = "verlet";
  auto world = make_world(scene);
  body_of(*world).effects.push_back(std::make_unique<Fault>(kNan, 1));
  EXPECT_FALSE(world->step());
  EXPECT_NE(body_of(*world).report.failure.find("vertex 17:"), std::string::npos);
}

/// Moves the first obstacle at 1 m/s along x.
class Conveyor final : public ObstacleDriver {
 public:
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    obstacles.front().pose_end = at(time, 0, 0);
  }
};

TEST(RollBackDetails, WhatMovesObstaclesIsTakenBackToo) {
  ClothScene scene;
  scene.obstacles = {obstacle(Plane())};
  auto world = make_world(scene);
  world->add_driver(std::make_unique<Conveyor>());
  body_of(*world).effects.push_back(std::make_unique<Fault>(kNan, 2));
  ASSERT_TRUE(world->step());
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_FALSE(world->step());
    EXPECT_EQ(world->obstacles()[0].pose_end.translation().x(), scene.time_step);
  }
  dynamic_cast<Fault&>(*body_of(*world).effects.back()).repair();
  ASSERT_TRUE(world->step());
  EXPECT_EQ(world->obstacles()[0].pose_start.translation().x(), scene.time_step);
  EXPECT_EQ(world->obstacles()[0].pose_end.translation().x(), 2 * scene.time_step);
}

class BadStart : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(BadStart);

TEST_P(BadStart, IsToldFromABlowUp) {
  ClothScene scene;
  scene.solver = GetParam();
  scene.time_step = 1e-3;
  scene.material = soft_material();
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  // In the middle: the vertices before it are spoilt by the step.
  particles_of(*world).v(0, 24) = kNan;
  EXPECT_FALSE(world->step());
  const std::string& failure = body_of(*world).report.failure;
  EXPECT_NE(failure.find("vertex 24: was not finite when the step began"), std::string::npos)
      << failure;
  particles_of(*world).v(0, 24) = 0.0;
  EXPECT_TRUE(world->step());
}

TEST(RollBackDetails, UndoesEveryBodyAndObstacle) {
  World world(0.01);
  world.add_obstacle(obstacle(Sphere(0.1), at(5, 0, 0)));
  for (int b = 0; b < 3; ++b) {
    const auto& entry = model_registry().find("cloth");
    const GridOptions grid{0.3, 0.3, 7, 7};
    Body& body = world.add_body("b" + std::to_string(b),
                                entry.make(parse_parameters(entry.parameters, {}, "test"),
                                           BodyGeometry{make_grid(grid), grid}));
    world.add_effect(body, effect_registry(), "gravity", {}, "test");
    world.set_solver(body, solver_registry(), "xpbd", {}, "test");
  }
  world.bodies()[1].effects.push_back(std::make_unique<Fault>(kNan, 1));
  world.set_initial_state();
  const Positions start = world.bodies()[0].particles().x;
  EXPECT_FALSE(world.step());
  for (const Body& body : world.bodies()) {
    EXPECT_EQ(body.particles().x, start);
    EXPECT_TRUE(body.particles().v.isZero(0.0));
  }
  EXPECT_TRUE(world.bodies()[0].report.failure.empty());
  EXPECT_NE(world.bodies()[1].report.failure.find("'b1'"), std::string::npos);
  dynamic_cast<Fault&>(*world.bodies()[1].effects.back()).repair();
  EXPECT_TRUE(world.step());
}

}  // namespace
}  // namespace pliant

// What effects keep from one step to the next, where the step of another body fails when theirs has
// ended already.
namespace pliant::undone_effects_test {
namespace {

/// What effects keep, and what the body keeps for them.
StateArchive effects_of(const Body& body) {
  StateArchive numbers;
  for (const auto& effect : body.effects) effect->save(numbers);
  return numbers;
}
StateArchive all_of(const Body& body) {
  StateArchive numbers = effects_of(body);
  body.model->system().save(numbers);
  return numbers;
}

void expect_equal(StateArchive a, StateArchive b) {
  ASSERT_EQ(a.size(), b.size());
  a.rewind();
  b.rewind();
  for (std::size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a.read(), b.read()) << k;
}

/// Two bodies that each have a solver's group of their own.
std::string two(const std::string& body, const std::string& effects) {
  return "time_step: 0.01\nbodies:\n  - {name: first, position: [0, 0, 0.3], " + body +
         "}\n  - {name: second, position: [1, 0, 0.3], " + body + "}\neffects: " + effects + "\n";
}

const std::string kJelly =
    "model: viscoelastic, geometry: {sphere: {radius: 0.025}, spacing: 0.01}, "
    "material: {density: 1000}";
const std::string kTowel =
    "model: cloth, geometry: {grid: {size: [0.2, 0.2], vertices: [6, 6]}}, "
    "material: {areal_density: 0.2}, fixed: [{corner: lower_left}]";

class UndoneEffects : public testing::TestWithParam<std::pair<const char*, std::string>> {};
INSTANTIATE_TEST_SUITE_P(
    Effects, UndoneEffects,
    testing::Values(
        std::pair("heat", two(kJelly,
                              "{gravity: {}, heat: {initial_temperature: 400, convection: 1e4, "
                              "conductivity: 10}}")),
        std::pair("plasticity", two(kJelly, "{gravity: {}, plasticity: {yield: 0, rate: 50}}")),
        std::pair("wetness", two(kTowel,
                                 "{gravity: {}, wetness: {wetness: 0.5, capacity: 0.3, "
                                 "drying: 0.1}}"))),
    [](const auto& info) { return info.param.first; });

TEST_P(UndoneEffects, AreWhereTheStepBegan) {
  const auto world = world_of(GetParam().second), twin = world_of(GetParam().second);
  // Deformed, so that there is something to creep.
  for (World* each : {world.get(), twin.get()}) {
    for (Body& body : each->bodies()) body.particles().v.row(0) = 20.0 * body.particles().x.row(2);
    for (int k = 0; k < 3; ++k) ASSERT_TRUE(each->step()) << each->failure();
  }
  Body& first = world->bodies().front();
  Body& second = world->bodies().back();
  const StateArchive before = effects_of(first);
  const Positions x = first.particles().x, v = second.particles().v;
  second.particles().v(0, 10) = std::numeric_limits<double>::quiet_NaN();
  ASSERT_FALSE(world->step());
  EXPECT_EQ(first.particles().x, x);
  expect_equal(effects_of(first), before);
  // As if it had not been tried.
  second.particles().v = v;
  ASSERT_TRUE(world->step()) << world->failure();
  ASSERT_TRUE(twin->step()) << twin->failure();
  EXPECT_EQ(first.particles().x, twin->bodies().front().particles().x);
  expect_equal(all_of(first), all_of(twin->bodies().front()));
}

}  // namespace
}  // namespace pliant::undone_effects_test
