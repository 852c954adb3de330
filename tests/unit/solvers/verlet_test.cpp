#include "pliant/solvers/iterations/verlet.h"

#include <gtest/gtest.h>

#include "pliant/core/body/wettable.h"
#include "pliant/effects/attachment.h"
#include "pliant/models/solver_registry.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

TEST(Verlet, WarnsAboveTheStepThatIsSurelyStable) {
  const auto warnings = [](double dt) {
    ClothScene scene;
    scene.solver = "verlet";
    scene.grid = {0.3, 0.3, 2, 2};
    scene.material = {{"shear", "0"}, {"bending", "0"}};
    scene.time_step = dt;
    scene.solver_parameters = {{"max_substeps", "1"}};
    auto world = make_world(scene);
    EXPECT_TRUE(world->step());
    return body_of(*world).report.warnings;
  };
  // Each corner weighs a quarter of the cell, 0.15 * 0.09 / 4 kg; its two springs of 250 N/m give
  // row sums of 1000 N/m: h = 2 sqrt(m / 1000).
  const double limit = 2.0 * std::sqrt(0.15 * 0.09 / 4.0 / 1000.0);
  EXPECT_TRUE(warnings(0.999 * limit).empty());
  const auto above = warnings(1.001 * limit);
  ASSERT_EQ(above.size(), 1u);
  EXPECT_NE(above[0].find("unstable_step"), std::string::npos);
  EXPECT_NE(above[0].find("largest step"), std::string::npos);
}

TEST(Verlet, TakesALongStepInSubstepsThatAreStable) {
  const auto scene_of = [](double dt) {
    ClothScene scene;
    scene.solver = "verlet";
    scene.fixed = {0, 6};
    scene.effects = {{"gravity", {}}};
    scene.time_step = dt;
    return scene;
  };
  const double dt = 0.02;
  auto world = make_world(scene_of(dt));
  ASSERT_TRUE(world->step());
  const int substeps = body_of(*world).substeps;
  ASSERT_GT(substeps, 4);
  const auto& metrics = body_of(*world).report.metrics;
  ASSERT_FALSE(metrics.empty());
  EXPECT_EQ(metrics.back().name, "substeps");
  EXPECT_EQ(metrics.back().value, substeps);
  auto short_steps = make_world(scene_of(dt / substeps));
  for (int k = 0; k < substeps; ++k) ASSERT_TRUE(short_steps->step());
  EXPECT_EQ(body_of(*short_steps).substeps, 1);
  for (int step = 0; step < 20; ++step) {
    EXPECT_EQ(particles_of(*world).x, particles_of(*short_steps).x) << step;
    EXPECT_TRUE(body_of(*world).report.warnings.empty());
    ASSERT_TRUE(world->step());
    for (int k = 0; k < substeps; ++k) ASSERT_TRUE(short_steps->step());
  }
  // One substep fewer would be too long for each.
  auto longer = make_world(scene_of(dt / (substeps - 1)));
  ASSERT_TRUE(longer->step());
  EXPECT_EQ(body_of(*longer).substeps, 2);
}

TEST(Verlet, GoesOnInSubstepsFromACheckpointAndAfterAnotherSolver) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.fixed = {0, 6};
  scene.effects = {{"gravity", {}}};
  scene.time_step = 0.02;
  auto world = make_world(scene), twin = make_world(scene);
  ASSERT_TRUE(world->advance(5));
  const int substeps = body_of(*world).substeps;
  ASSERT_GT(substeps, 4);
  twin->load(world->save());
  ASSERT_TRUE(world->advance(5));
  ASSERT_TRUE(twin->advance(5));
  EXPECT_EQ(particles_of(*world).x, particles_of(*twin).x);
  EXPECT_EQ(body_of(*twin).substeps, substeps);
  // A solver that bears any step takes it whole; after it verlet takes substeps again.
  world->set_solver(body_of(*world), all_solvers(), "lbfgs", {}, "test");
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).substeps, 1);
  world->set_solver(body_of(*world), all_solvers(), "verlet", {}, "test");
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).substeps, substeps);
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
}

TEST(Verlet, TakesAsManySubstepsAsItMay) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.solver_parameters = {{"max_substeps", "3"}};
  scene.time_step = 0.02;
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(body_of(*world).substeps, 3);
  const auto& warnings = body_of(*world).report.warnings;
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("unstable_step: 0.00666667 s"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("max_substeps"), std::string::npos);
}

TEST(Verlet, TakesShorterSubstepsFromTheStepInWhichAStiffSpringBegins) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.effects = {{"gravity", {}}};
  scene.time_step = 0.01;
  auto world = make_world(scene);
  AttachmentRequest hook;
  hook.name = "hook";
  hook.region.vertices = {0, 1};
  hook.count = particles_of(*world).size();
  hook.stiffness = 1e5;
  hook.from = 0.03;
  attachments_of(body_of(*world), world->obstacles()).add(hook);
  ASSERT_TRUE(world->advance(3));
  const int substeps = body_of(*world).substeps;
  for (int k = 0; k < 30; ++k) {
    ASSERT_TRUE(world->step());
    EXPECT_GT(body_of(*world).substeps, 4 * substeps) << k;
    EXPECT_TRUE(body_of(*world).report.warnings.empty()) << k;
    EXPECT_LT(particles_of(*world).v.cwiseAbs().maxCoeff(), 10.0) << k;
  }
}

TEST(Verlet, FollowsMassesThatChange) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.time_step = 0.02;
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  const int substeps = body_of(*world).substeps;
  auto* masses = body_of(*world).model->find<Wettable>();
  ASSERT_NE(masses, nullptr);
  for (int i = 0; i < particles_of(*world).size(); ++i) {
    masses->set_mass(i, 0.25 * particles_of(*world).mass[i]);
  }
  ASSERT_TRUE(world->step());
  EXPECT_NEAR(body_of(*world).substeps, 2 * substeps, 1);
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
}

TEST(Verlet, WithoutSpringsAnyStepIsStable) {
  ClothScene scene;
  scene.solver = "verlet";
  scene.time_step = 1.0;
  scene.material = {{"stretch_warp", "0"}, {"stretch_weft", "0"}, {"shear", "0"}, {"bending", "0"}};
  auto world = make_world(scene);
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(body_of(*world).report.warnings.empty());
}

}  // namespace
}  // namespace pliant
