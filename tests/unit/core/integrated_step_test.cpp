// Steps of second order as a part of a world: saved, reset, undone, swapped, refused.
#include "pliant/core/step/integrated_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/core/step/body_integration.h"
#include "pliant/solvers/time/time_integrations.h"
#include "support/expect_refusal.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/reduced_worlds.h"
#include "support/worlds/worlds.h"

namespace pliant::integrated_step_test {
namespace {

/// Every effect that keeps something, in motion; falls on a sphere after 0.07 s.
ClothScene full_scene(const std::string& solver) {
  return falling_scene(solver, 0.065,
                       {{"volume", "1e-4"}, {"fill_time", "0.1"}, {"permeability", "1e-6"}});
}

/// A sheet of two parts that fly and swing freely.
ClothScene free_scene(const std::string& solver) {
  ClothScene scene;
  scene.material = soft_material();
  scene.solver = solver;
  scene.solver_parameters = converged(solver);
  scene.time_step = 1e-3;
  return scene;
}

void integrate_by(World& world, const std::string& name) {
  world.set_time_integration(body_of(world), time_integrations(), name);
}

std::string_view why_first_order(World& world) { return body_of(world).report.first_order; }

class IntegratedStepOfEverySolver : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(IntegratedStepOfEverySolver);

TEST_P(IntegratedStepOfEverySolver, GoesOnFromACheckpointAndAfterAResetBitForBit) {
  for (const std::string name : {"bdf2", "midpoint"}) {
    for (const bool has_contact : {true, false}) {
      const auto make = [&] {
        ClothScene scene = has_contact ? full_scene(solver()) : free_scene(solver());
        if (!has_contact) scene.solver_parameters = few_iterations(solver(), 7);
        auto world = make_world(scene);
        integrate_by(*world, name);
        return world;
      };
      auto world = make();
      run_for(*world, 0.03);
      const Checkpoint checkpoint = world->save();
      run_for(*world, 0.03);
      const Particles once = particles_of(*world);
      world->load(checkpoint);
      run_for(*world, 0.03);
      EXPECT_EQ(particles_of(*world).x, once.x) << name;
      EXPECT_EQ(particles_of(*world).v, once.v) << name;
      auto twin = make();
      run_for(*twin, 0.002);
      twin->load(checkpoint);
      run_for(*twin, 0.03);
      EXPECT_EQ(particles_of(*twin).x, once.x) << name;
      world->reset();
      run_for(*world, 0.06);
      EXPECT_EQ(particles_of(*world).x, once.x) << name;
      EXPECT_EQ(particles_of(*world).v, once.v) << name;
    }
  }
}

TEST(IntegratedStep, BodiesThatTouchGoOnFromACheckpointBitForBit) {
  for (const std::string name : {"bdf2", "midpoint"}) {
    for (const std::string solver : {"lbfgs", "chebyshev"}) {
      const auto world = world_of(scene_text(
          {slab("one", "patch", 0.11, "velocity: [0, 0, -0.5]"), slab("other", "patch", 0.05)},
          "  gravity: {}\n  body_contact: {}\n",
          "solver: {name: " + solver + "}\ntime_integration: " + name + "\n"));
      run_for(*world, 0.1);
      const Checkpoint checkpoint = world->save();
      run_for(*world, 0.1);
      const Positions once = world->bodies()[0].particles().x;
      world->load(checkpoint);
      run_for(*world, 0.1);
      EXPECT_EQ(world->bodies()[0].particles().x, once) << name << " " << solver;
      world->reset();
      run_for(*world, 0.2);
      EXPECT_EQ(world->bodies()[0].particles().x, once) << name << " " << solver;
    }
  }
}

TEST(IntegratedStep, AStepThatFailsIsUndoneWithItsHistory) {
  for (const std::string name : {"bdf2", "midpoint"}) {
    auto world = make_world(full_scene("newton")), twin = make_world(full_scene("newton"));
    for (World* each : {world.get(), twin.get()}) {
      integrate_by(*each, name);
      run_for(*each, 0.01);
    }
    AppliedForce push;
    push.force = Eigen::Vector3d(0, 0, 1e12);
    push.duration = -1.0;
    world->applied_forces().add(push);
    EXPECT_FALSE(world->step());
    EXPECT_NE(world->failure(), "");
    world->applied_forces().clear();
    EXPECT_EQ(particles_of(*world).x, particles_of(*twin).x);
    EXPECT_EQ(particles_of(*world).v, particles_of(*twin).v);
    ASSERT_TRUE(world->step());
    ASSERT_TRUE(twin->step());
    EXPECT_EQ(why_first_order(*world), "") << name << ": it knows the step before";
    EXPECT_LE((particles_of(*world).x - particles_of(*twin).x).norm(), 1e-12) << name;
  }
}

TEST(IntegratedStep, SwapsInMotionKeepWhatMoves) {
  auto world = make_world(free_scene("newton"));
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) p.v.col(i) << 0.2 - 3.0 * p.x(1, i), 3.0 * p.x(0, i), 0.1;
  const Eigen::Vector3d momentum = p.momentum(), angular = p.angular_momentum();
  const double energy = world->energies().total();
  const std::vector<std::string> integrations = {"bdf2", "midpoint"};
  const std::vector<std::string> solvers = {"newton", "direct", "lbfgs"};
  for (std::size_t k = 0; k < 100; ++k) {
    const Particles before = p;
    integrate_by(*world, integrations[k % 2]);
    const std::string& solver = solvers[k % 3];
    world->set_solver(body_of(*world), solver_registry(), solver, converged(solver), "test");
    EXPECT_EQ(p.x, before.x);
    EXPECT_EQ(p.v, before.v);
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body_of(*world).report.time_integration, integrations[k % 2]);
    EXPECT_EQ(why_first_order(*world), k == 0 ? "start" : "") << "others know the step before";
  }
  const double scale = (p.v.colwise().norm() * p.mass)(0);
  EXPECT_LE((p.momentum() - momentum).norm(), 1e-9 * scale);
  EXPECT_LE((p.angular_momentum() - angular).norm(), 1e-6 * angular.norm());
  EXPECT_NEAR(world->energies().total(), energy, 0.01 * energy);
}

TEST(IntegratedStep, AFlatSheetThatHitsIsNotThrownBack) {
  // A step of second order would go on from the velocity before the hit.
  ClothScene scene = free_scene("newton");
  scene.obstacles = {obstacle(Plane())};
  scene.pose = at(0.0, 0.0, 0.002);  // 1 mm above where it touches
  scene.effects = {{"gravity", {}}, {"contact", {}}};
  auto world = make_world(scene);
  integrate_by(*world, "bdf2");
  body_of(*world).model->set_velocity(Eigen::Vector3d(0, 0, -0.1));
  while (body_of(*world).report.contacts == 0 && world->time() < 0.05) ASSERT_TRUE(world->step());
  // 0.1 m/s t + 9.81 m/s² t²/2 = 1 mm.
  EXPECT_NEAR(world->time(), 0.00735, scene.time_step);
  EXPECT_EQ(body_of(*world).report.first_order, "impact") << "which one of its parts is";
  for (int k = 0; k < 5; ++k) {
    EXPECT_LE(particles_of(*world).v.row(2).maxCoeff(), 1e-6) << k;
    ASSERT_TRUE(world->step());
  }
}

TEST(IntegratedStep, DampingActsOnce) {
  // What effects do to velocities between steps has no share in what goes on from step to step.
  for (const std::string name : {"implicit_euler", "bdf2", "midpoint"}) {
    ClothScene scene = free_scene("newton");
    scene.effects = {{"damping", {{"rate", "3"}}}};
    auto world = make_world(scene);
    integrate_by(*world, name);
    body_of(*world).model->set_velocity(Eigen::Vector3d(1, 0, 0));
    run_for(*world, 0.5);
    EXPECT_NEAR(particles_of(*world).v(0, 0), std::exp(-3.0 * 0.5), 1e-9) << name;
  }
}

TEST(IntegratedStep, ASolverWithAnIntegrationOfItsOwnIsRefusedBesideAnother) {
  auto world = make_world(free_scene("newton"));
  integrate_by(*world, "bdf2");
  ASSERT_TRUE(world->step());
  const auto set = [&](const std::string& name) {
    world->set_solver(body_of(*world), solver_registry(), name, {}, "test");
  };
  expect_refusal([&] { set("verlet"); },
                 {"time_integration 'bdf2' is for implicit solvers", "'verlet'", "implicit_euler"});
  EXPECT_EQ(body_of(*world).solver->name(), "newton");
  EXPECT_TRUE(world->step());
  EXPECT_EQ(time_integration_of(body_of(*world)), "bdf2");
  integrate_by(*world, "implicit_euler");
  EXPECT_EQ(time_integration_of(body_of(*world)), "implicit_euler");
  set("verlet");
  EXPECT_EQ(time_integration_of(body_of(*world)), "");
  expect_refusal([&] { integrate_by(*world, "midpoint"); }, {"'midpoint'", "'verlet'"});
  EXPECT_EQ(time_integration_of(body_of(*world)), "");
  EXPECT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).report.time_integration, "");
}

TEST(IntegratedStep, UnknownOnesAndModelsWithTheirOwnAreRefused) {
  auto world = make_world(free_scene("newton"));
  expect_refusal([&] { integrate_by(*world, "bdf3"); },
                 {"unknown time_integration 'bdf3'", "did you mean 'bdf2'"});
  auto reduced = make_world(ReducedScene());
  expect_refusal([&] { integrate_by(*reduced, "bdf2"); },
                 {"time_integration 'bdf2' does not work for model 'reduced'"});
  EXPECT_TRUE(reduced->step());
}

TEST(IntegratedStep, RunsOnTheCpuAndSaysSo) {
  for (const std::string backend : {"cuda", "auto"}) {
    ClothScene scene = free_scene("jacobi");
    scene.solver_parameters["backend"] = backend;
    auto world = make_world(scene);
    const auto is_told = [&] {
      const auto& warnings = body_of(*world).report.warnings;
      return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
        return warning.find("backend_ignored: body ") == 0;
      });
    };
    ASSERT_TRUE(world->step());
    EXPECT_FALSE(is_told());
    integrate_by(*world, "bdf2");
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body_of(*world).report.backend, "cpu");
    EXPECT_EQ(is_told(), backend == "cuda");
    EXPECT_EQ(body_of(*world).report.backend_reason,
              backend == "auto" ? "bdf2 runs there alone" : "");
  }
}

}  // namespace
}  // namespace pliant::integrated_step_test
