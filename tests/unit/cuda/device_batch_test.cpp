// Scenes whose iterations run as one, their kernels run by the CPU: what one scene does depends on
// no other.
#include <gtest/gtest.h>

#include "support/random.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/failing_executor.h"
#include "support/solvers/host_device_solver.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/particle_bodies.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::device_batch_test {
namespace {

using HostBatch = DeviceBatch<HostExecutor>;

std::unique_ptr<World> cloth(int rows, double friction) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, rows, 9};
  scene.pose = at(0.02, 0.01, 0.101);
  scene.obstacles = {obstacle(Sphere(0.1))};
  scene.effects = {
      {"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", std::to_string(friction)}}}};
  return make_world(scene);
}

std::unique_ptr<World> block(double friction) {
  PatchScene scene = falling_block("jacobi", {});
  scene.effects.push_back({"friction", {{"coefficient", std::to_string(friction)}}});
  return make_world(scene);
}

DeviceSolverSpec spec(int iterations) {
  return device_solver_spec("chebyshev", {iterations, 0.0, 0.0});
}

void use(World& world, const std::string& solver, int iterations, HostBatch* batch) {
  body_of(world).solver = std::make_unique<DeviceSolver<HostExecutor>>(
      device_solver_spec(solver, {iterations, 0.0, 0.0}), batch);
  world.system_changed();
}

struct Case {
  const char* name;
  std::function<std::vector<std::unique_ptr<World>>()> make;
  std::vector<int> iterations;
  int changes_at;  ///< step at which one is prepared anew
  std::vector<const char*> solvers = {"chebyshev", "chebyshev", "chebyshev"};
};

/// A cloth that two corners hold.
std::unique_ptr<World> hanging(int rows) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, rows, 9};
  scene.fixed = {0, 8};
  scene.effects = {{"gravity", {}}};
  return make_world(scene);
}

std::vector<Case> cases() {
  return {{"Cloths",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             // 63, 99 and 72 vertices: a block that is not full, two blocks.
             worlds.push_back(cloth(7, 0.2));
             worlds.push_back(cloth(11, 0.6));
             worlds.push_back(cloth(8, 0.0));
             return worlds;
           },
           {30, 30, 30},
           12},
          {"BlocksAndACloth",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             worlds.push_back(block(0.1));
             worlds.push_back(cloth(11, 0.5));
             worlds.push_back(block(0.8));
             return worlds;
           },
           {25, 25, 25},
           -1},  // then rotations are searched for anew
          {"OtherNumbersOfIterations",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             for (double friction : {0.1, 0.2, 0.3}) worlds.push_back(cloth(9, friction));
             return worlds;
           },
           {10, 20, 0},
           12},
          {"Sweeps",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             // Of 8 colours and of as many as it takes; of points alone and of those that share.
             worlds.push_back(cloth(7, 0.2));
             worlds.push_back(cloth(11, 0.6));
             worlds.push_back(block(0.4));
             return worlds;
           },
           {12, 12, 12},
           -1,
           {"hybrid", "gauss_seidel", "hybrid"}},
          {"Weighted",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             worlds.push_back(hanging(7));
             worlds.push_back(cloth(11, 0.6));  // with contact: Jacobi iterations
             worlds.push_back(hanging(10));
             return worlds;
           },
           {12, 12, 12},
           12,
           {"line_search_jacobi", "line_search_jacobi", "line_search_jacobi"}},
          {"QuasiNewton",
           [] {
             std::vector<std::unique_ptr<World>> worlds;
             worlds.push_back(hanging(7));
             worlds.push_back(cloth(11, 0.6));
             worlds.push_back(block(0.4));
             return worlds;
           },
           {10, 10, 10},  // more than one launch
           -1,
           {"lbfgs", "lbfgs", "lbfgs"}}};
}

class DeviceBatchOf : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, DeviceBatchOf, testing::ValuesIn(cases()),
                         [](const auto& info) { return info.param.name; });

TEST_P(DeviceBatchOf, EachSceneDoesWhatItDoesAlone) {
  HostBatch batch;
  const auto together = GetParam().make(), alone = GetParam().make();
  for (std::size_t s = 0; s < together.size(); ++s) {
    const Case& given = GetParam();
    use(*together[s], given.solvers[s], given.iterations[s], &batch);
    use(*alone[s], given.solvers[s], given.iterations[s], nullptr);
  }
  int contacts = 0;
  for (int step = 0; step < 25; ++step) {
    // One is prepared anew, as after a change of its elements, and one rests now and then.
    if (step == GetParam().changes_at) {
      together[1]->system_changed();
      alone[1]->system_changed();
    }
    const auto steps = [&](std::size_t s) { return s != 2 || step % 5 != 3; };
    for (std::size_t s = 0; s < together.size(); ++s) {
      if (steps(s)) together[s]->begin_step();
    }
    batch.run();
    for (std::size_t s = 0; s < together.size(); ++s) {
      if (!steps(s)) continue;
      ASSERT_TRUE(together[s]->finish_step()) << together[s]->failure();
      ASSERT_TRUE(alone[s]->step()) << alone[s]->failure();
      ASSERT_EQ(particles_of(*together[s]).x, particles_of(*alone[s]).x) << s << " at " << step;
      contacts += body_of(*alone[s]).report.contacts;
    }
  }
  EXPECT_GT(contacts, 0);
}

TEST(DeviceBatch, AFailureOfTheDeviceReachesEverySolver) {
  FailingExecutor::left = 1;
  DeviceBatch<FailingExecutor> batch;
  const auto first = cloth(7, 0.1), second = cloth(8, 0.1);
  for (World* world : {first.get(), second.get()}) {
    body_of(*world).solver = with_fallback(
        "cuda", make_solver("xpbd"),
        [](SolverBatch* joined) {
          return std::make_unique<DeviceSolver<FailingExecutor>>(
              spec(10), dynamic_cast<DeviceBatch<FailingExecutor>*>(joined));
        },
        10);
    ASSERT_TRUE(body_of(*world).solver->join(batch));
    world->system_changed();
    world->begin_step();
  }
  batch.run();
  for (World* world : {first.get(), second.get()}) {
    ASSERT_TRUE(world->finish_step());
    EXPECT_EQ(body_of(*world).report.backend, "cpu");
    ASSERT_FALSE(body_of(*world).report.warnings.empty());
    EXPECT_NE(body_of(*world).report.warnings[0].find("out of memory"), std::string::npos);
  }
}

TEST(DeviceBatch, LeavesToTheCpuWhatTakesStepsInSubsteps) {
  ViscoelasticModel::Material material;
  material.beta = 0.5;
  HostBatch batch;
  ParticleWorld joined(sampled_box({0.05, 0.05, 0.05}, 0.01), material, 0.01),
      alone(sampled_box({0.05, 0.05, 0.05}, 0.01), material, 0.01);
  for (ParticleWorld* world : {&joined, &alone}) {
    world->add_effect("gravity");
    world->start("chebyshev", {{"iterations", "10"}});
  }
  joined.body().solver = with_fallback(
      "cuda", make_solver("chebyshev", {{"iterations", "10"}}),
      [](SolverBatch* to) {
        return std::make_unique<DeviceSolver<HostExecutor>>(spec(10), dynamic_cast<HostBatch*>(to));
      },
      10);
  ASSERT_TRUE(joined.body().solver->join(batch));
  joined.world().system_changed();
  for (int step = 0; step < 3; ++step) {
    joined.world().begin_step();
    batch.run();
    ASSERT_TRUE(joined.world().finish_step()) << joined.world().failure();
    ASSERT_GT(joined.body().substeps, 1);
    EXPECT_EQ(joined.body().report.backend, "cpu");
    ASSERT_TRUE(alone.world().step());
    EXPECT_LE((joined.particles().x - alone.particles().x).norm(), 1e-9);
  }
}

TEST(DeviceBatch, TakesNoSolverOfTheCpu) {
  HostBatch batch;
  const auto world = cloth(7, 0.1);
  EXPECT_FALSE(body_of(*world).solver->join(batch));
}

}  // namespace
}  // namespace pliant::device_batch_test
