// Solvers whose iterations read the matrix of projective dynamics, on a GPU against those of the
// same names on the CPU.
#include <gtest/gtest.h>

#include "cuda/brief.h"
#include "cuda/on_gpu.h"
#include "cuda/skip_without_gpu.h"
#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/solvers/device/solver_batch.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/draped_cloth.h"
#include "support/worlds/patch_worlds.h"

namespace pliant {
namespace {

class MatrixSolverOnGpu : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, MatrixSolverOnGpu,
                         testing::Values("line_search_jacobi", "gauss_seidel", "hybrid"),
                         [](const auto& info) { return info.param; });

/// And lbfgs, whose first inverse Hessian is another one than on the CPU.
class AnyMatrixSolverOnGpu : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, AnyMatrixSolverOnGpu,
                         testing::Values("line_search_jacobi", "gauss_seidel", "hybrid", "lbfgs"),
                         [](const auto& info) { return info.param; });

TEST_P(MatrixSolverOnGpu, EachIterationIsThatOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  for (const StepProblem& problem : step_problems()) {
    if (!why_not_packed(problem.make()).empty()) continue;
    for (int count : {1, 2, 12, 40}) {
      const ProjectiveSystem exact = after_step(problem, GetParam(), iterations(count));
      ProjectiveSystem system = problem.make();
      const StepReport report = step_of(system, GetParam(), on_gpu(count), problem.dt);
      EXPECT_EQ(report.backend, "cuda");
      const Positions& x = exact.particles.x;
      EXPECT_LE((system.particles.x - x).cwiseAbs().maxCoeff(), single_round_off(x, count))
          << problem.name << " after " << count;
    }
  }
}

TEST_P(MatrixSolverOnGpu, ContactAndFrictionAreThoseOfTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  constexpr int kCount = 8;
  const auto cpu = draped_cloth(GetParam(), iterations(kCount)),
             gpu = draped_cloth(GetParam(), iterations(kCount));
  for (int s = 0; s < 25; ++s) {
    ASSERT_TRUE(cpu->step()) << cpu->failure();
    ASSERT_TRUE(gpu->step()) << gpu->failure();
  }
  gpu->set_solver(body_of(*gpu), solver_registry(), GetParam(), on_gpu(kCount), "test");
  ASSERT_TRUE(cpu->step());
  ASSERT_TRUE(gpu->step()) << gpu->failure();
  EXPECT_EQ(body_of(*gpu).report.backend, "cuda");
  EXPECT_GT(body_of(*cpu).report.contacts, 5);
  const Positions& x = particles_of(*cpu).x;
  EXPECT_LE((particles_of(*gpu).x - x).cwiseAbs().maxCoeff(), single_round_off(x, kCount));
  for (std::size_t k = 0; k < 2; ++k) {
    const Eigen::Vector3d force = cpu->reactions()[k].force;
    EXPECT_LE((gpu->reactions()[k].force - force).norm(), 1e-3 * force.norm()) << k;
  }
}

TEST_P(AnyMatrixSolverOnGpu, PointsThatShareParticlesComeToRestAsOnTheCpu) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto cpu =
      make_world(falling_block("newton", {{"iterations", "300"}, {"tolerance", "1e-9"}}));
  const auto gpu =
      make_world(falling_block(GetParam(), on_gpu(times(500, 8), {{"tolerance", "1e-5"}})));
  const Positions& x = particles_of(*cpu).x;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  int contacts = 0;
  for (int s = 0; s < 20; ++s) {
    ASSERT_TRUE(cpu->step()) << cpu->failure();
    ASSERT_TRUE(gpu->step()) << gpu->failure();
    contacts = std::max(contacts, body_of(*cpu).report.contacts);
    if (is_brief()) continue;
    EXPECT_LE((x - particles_of(*gpu).x).colwise().norm().maxCoeff(), 1e-4 * size) << s;
  }
  EXPECT_GT(contacts, 3);
}

TEST_P(AnyMatrixSolverOnGpu, RunsRepeatBitForBit) {
  PLIANT_SKIP_WITHOUT_GPU();
  const ParameterText parameters = on_gpu(times(30, 4));
  const auto first = draped_cloth(GetParam(), parameters),
             second = draped_cloth(GetParam(), parameters);
  for (int s = 0; s < times(60, 30); ++s) {
    ASSERT_TRUE(first->step());
    ASSERT_TRUE(second->step());
  }
  EXPECT_EQ(body_of(*first).report.backend, "cuda");
  EXPECT_EQ(particles_of(*first).x, particles_of(*second).x);
  EXPECT_EQ(particles_of(*first).v, particles_of(*second).v);
}

TEST_P(AnyMatrixSolverOnGpu, StepsOnEndAreThoseOneByOne) {
  PLIANT_SKIP_WITHOUT_GPU();
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const ParameterText parameters = on_gpu(times(100, 4));
    const auto single = draped_cloth(GetParam(), parameters),
               resident = draped_cloth(GetParam(), parameters);
    ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->step());
    ASSERT_GE(resident->resident_limit(20), 2);
    for (int k = 0; k < 20; ++k) ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->advance(20));
    EXPECT_EQ(body_of(*resident).report.backend, "cuda");
    ends.push_back(particles_of(*resident).x);
    // Four iterations leave what hangs on where they begin, and on round-off.
    if (is_brief()) continue;
    const Positions& x = particles_of(*single).x;
    EXPECT_LE((ends.back() - x).cwiseAbs().maxCoeff(), 1e-4 * 0.3);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST_P(AnyMatrixSolverOnGpu, EachSceneOfABatchDoesWhatItDoesAlone) {
  PLIANT_SKIP_WITHOUT_GPU();
  const ParameterText parameters = on_gpu(times(20, 3));
  const auto hanging = [&](int nodes) {
    ClothScene scene;
    scene.grid = {0.3, 0.3, nodes, nodes};
    scene.fixed = {0, nodes - 1};
    scene.effects = {{"gravity", {}}};
    scene.solver = GetParam();
    scene.solver_parameters = parameters;
    return make_world(scene);
  };
  std::vector<std::unique_ptr<World>> together, alone;
  const auto batch = make_cuda_batch();
  for (int nodes : {9, 12, 30}) {
    for (bool touches : {false, true}) {
      auto& joined =
          together.emplace_back(touches ? draped_cloth(GetParam(), parameters) : hanging(nodes));
      alone.push_back(touches ? draped_cloth(GetParam(), parameters) : hanging(nodes));
      ASSERT_TRUE(body_of(*joined).solver->join(*batch));
      joined->system_changed();
      alone.back()->system_changed();
    }
  }
  for (int step = 0; step < times(60, 20); ++step) {
    for (const auto& world : together) world->begin_step();
    batch->run();
    for (std::size_t s = 0; s < together.size(); ++s) {
      ASSERT_TRUE(together[s]->finish_step()) << together[s]->failure();
      ASSERT_TRUE(alone[s]->step()) << alone[s]->failure();
      ASSERT_EQ(body_of(*together[s]).report.backend, "cuda");
      ASSERT_EQ(particles_of(*together[s]).x, particles_of(*alone[s]).x) << s << " at " << step;
    }
  }
  together.clear();  // before the batch
}

TEST(LbfgsOnGpu, ConvergesAsWithTheFactor) {
  PLIANT_SKIP_WITHOUT_GPU();
  for (const StepProblem& problem : step_problems()) {
    if (!why_not_packed(problem.make()).empty()) continue;
    const ProjectiveSystem exact = after_converged_step(problem);
    const double distance = (exact.particles.x - exact.particles.x_start).norm();
    const auto error = [&](const ProjectiveSystem& system) {
      return (system.particles.x - exact.particles.x).norm() / distance;
    };
    for (int count : {6, 12, 400}) {
      ProjectiveSystem system = problem.make();
      const StepReport report = step_of(system, "lbfgs", on_gpu(count), problem.dt);
      EXPECT_EQ(report.backend, "cuda");
      const ProjectiveSystem on_cpu = after_step(problem, "lbfgs", iterations(count));
      EXPECT_LE(error(system), 1.5 * error(on_cpu) + 1e-4) << problem.name << " after " << count;
    }
  }
}

TEST(MatrixSolverRefusals, WhatTheCpuAloneComputesIsRefusedByName) {
  PLIANT_SKIP_WITHOUT_GPU();
  const auto refusal = [](const std::string& solver, ParameterText parameters) -> std::string {
    parameters["backend"] = "cuda";
    try {
      draped_cloth(solver, parameters)->step();
    } catch (const InputError& error) {
      return error.what();
    }
    return "it was taken";
  };
  const std::string history = refusal("lbfgs", {{"history", "9"}});
  EXPECT_NE(history.find("'history'"), std::string::npos) << history;
}

}  // namespace
}  // namespace pliant
