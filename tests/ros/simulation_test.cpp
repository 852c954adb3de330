#include "pliant/ros/simulation.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/models/solver_registry.h"
#include "pliant/ros/what_runs.h"
#include "pliant/solvers/backend.h"

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
    EXPECT_EQ(simulation_.solvers(), "imex, xpbd") << "a refusal changes nothing";
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

TEST_F(SimulationOfTwoModels, RefusesASolverThatDoesNotSuit) {
  refused("jacobi", "", {"works for 'cloth'", "not for 'beam'", "'reduced'", "name a 'body'"});
  refused("newmark", "", {"works for 'beam'", "not for 'cloth'", "name a 'body'"});
  refused("jacobi", "beam", {"'jacobi' does not work for model 'reduced'"});
  refused("jacoby", "", {"unknown solver 'jacoby'", "did you mean 'jacobi'"});
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
  says("solver imex on cpu, topics /n/beam/surface /n/beam/points");
  says("cloth: cloth, 25 vertices, solver xpbd on cpu");
  says("rosservice call /n/reset");
  ASSERT_TRUE(simulation_.make_step());
  Body& cloth = simulation_.world().bodies()[1];
  cloth.solver = solver_on_a_device();
  simulation_.world().system_changed();
  says("cloth: cloth, 25 vertices, solver xpbd on cuda");
  says("solver imex on cpu");
}

}  // namespace
}  // namespace pliant
