// Solvers of the CUDA backend whose iterations read the matrix of projective dynamics, their
// kernels run by the CPU: iteration by iteration what the CPU's solvers of the same names do.
#include <gtest/gtest.h>

#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/core/parallel/parallel.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/math/error.h"
#include "pliant/solvers/iterations/lbfgs.h"
#include "support/random.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/draped_cloth.h"

namespace pliant {
namespace {

StepReport device_step(ProjectiveSystem& system, const std::string& name, int count, double dt) {
  const auto solver = make_host_device_solver(name, {count, 0.0, 0.0});
  solver->prepare(system, dt);
  return step_of(system, *solver, dt);
}

class DeviceMatrixStepOn : public testing::TestWithParam<StepProblem> {
 protected:
  void SetUp() override {
    if (!why_not_packed(GetParam().make()).empty()) GTEST_SKIP() << "not for a device";
  }
};
INSTANTIATE_TEST_SUITE_P(Problems, DeviceMatrixStepOn, testing::ValuesIn(step_problems()),
                         problem_name);

TEST_P(DeviceMatrixStepOn, EachIterationIsThatOfTheCpu) {
  const StepProblem& problem = GetParam();
  for (const char* name : {"line_search_jacobi", "gauss_seidel", "hybrid"}) {
    for (int count : {1, 2, 12}) {
      const ProjectiveSystem exact = after_step(problem, name, iterations(count));
      ProjectiveSystem system = problem.make();
      const StepReport report = device_step(system, name, count, problem.dt);
      EXPECT_EQ(report.backend, "cuda");
      EXPECT_EQ(report.iterations, count);
      const Positions& x = exact.particles.x;
      const Positions displacements = x - prediction(exact, problem.dt);
      const double off = (system.particles.x - x).cwiseAbs().maxCoeff();
      EXPECT_LE(off, single_round_off(x, count)) << name << " after " << count;
      EXPECT_GT(displacements.cwiseAbs().maxCoeff(), 20.0 * single_round_off(x, count))
          << "it tests nothing";
    }
  }
}

TEST_P(DeviceMatrixStepOn, TellsWhatTheCpuTells) {
  const StepProblem& problem = GetParam();
  constexpr int kCount = 5;
  for (const char* name : {"line_search_jacobi", "hybrid"}) {
    ProjectiveSystem on_cpu = problem.make(), system = problem.make();
    const StepReport exact = step_of(on_cpu, name, iterations(kCount), problem.dt);
    const StepReport report = device_step(system, name, kCount, problem.dt);
    // The residual is that before the last iteration on either; below that it is round-off.
    EXPECT_NEAR(report.residual, exact.residual, 1e-3 * exact.residual + 1e-6) << name;
    ASSERT_FALSE(exact.metrics.empty());
    for (const auto& told : exact.metrics) {
      EXPECT_NEAR(metric(report, told.name), told.value, 1e-3 * std::abs(told.value)) << told.name;
    }
  }
}

TEST(DeviceHybrid, FewColoursLeaveAnOverflowAsOnTheCpu) {
  constexpr int kCount = 6;
  constexpr double kStep = 0.005;
  for (int colors : {1, 2, 3}) {
    const auto make = [] { return solid_block({1e5, 0.0, 1000.0}); };
    ProjectiveSystem exact = make(), system = make();
    const StepReport told = step_of(
        exact, "hybrid",
        {{"colors", std::to_string(colors)}, {"iterations", std::to_string(kCount)}}, kStep);
    EXPECT_GT(metric(told, "overflow"), 0.0);
    DeviceSolverSpec spec = device_solver_spec("hybrid", {kCount, 0.0, 0.0});
    spec.iteration.colors = colors;
    const auto solver = make_host_device_solver(spec);
    solver->prepare(system, kStep);
    const StepReport report = step_of(system, *solver, kStep);
    EXPECT_EQ(metric(report, "overflow"), metric(told, "overflow"));
    EXPECT_NEAR(report.residual, told.residual, 1e-3 * told.residual);
    const Positions& x = exact.particles.x;
    EXPECT_LE((system.particles.x - x).cwiseAbs().maxCoeff(), single_round_off(x, kCount))
        << colors;
  }
}

class DeviceMatrixWorld : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, DeviceMatrixWorld,
                         testing::Values("line_search_jacobi", "gauss_seidel", "hybrid"),
                         [](const auto& info) { return info.param; });

TEST_P(DeviceMatrixWorld, ContactAndFrictionAreThoseOfTheCpu) {
  constexpr int kCount = 8;
  const auto on_cpu = draped_cloth(GetParam(), iterations(kCount)),
             world = draped_cloth(GetParam(), iterations(kCount));
  for (int s = 0; s < 25; ++s) {
    ASSERT_TRUE(on_cpu->step()) << on_cpu->failure();
    ASSERT_TRUE(world->step()) << world->failure();
  }
  body_of(*world).solver = make_host_device_solver(GetParam(), {kCount, 0.0, 0.0});
  world->system_changed();
  ASSERT_TRUE(on_cpu->step());
  ASSERT_TRUE(world->step()) << world->failure();
  EXPECT_EQ(body_of(*world).report.backend, "cuda");
  const Positions& x = particles_of(*on_cpu).x;
  EXPECT_LE((particles_of(*world).x - x).cwiseAbs().maxCoeff(), single_round_off(x, kCount));
  EXPECT_GT(body_of(*on_cpu).report.contacts, 5);
  if (GetParam() != "line_search_jacobi") {
    // Over the same forces: those of the first two iterations, contacts' among them.
    const double residual = body_of(*on_cpu).report.residual;
    EXPECT_NEAR(body_of(*world).report.residual, residual, 1e-3 * residual);
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const Eigen::Vector3d force = on_cpu->reactions()[k].force;
    EXPECT_GT(force.norm(), 0.0);
    EXPECT_LE((world->reactions()[k].force - force).norm(), 1e-3 * force.norm()) << k;
  }
}

TEST_P(DeviceMatrixWorld, RepeatsBitForBitForAnyNumberOfThreads) {
  std::vector<Positions> ends;
  const int before = threads();
  for (int count : {1, 3}) {
    set_threads(count);
    const auto world = draped_cloth("jacobi", {});
    body_of(*world).solver = make_host_device_solver(GetParam(), {12, 0.0, 0.0});
    world->system_changed();
    for (int s = 0; s < 20; ++s) ASSERT_TRUE(world->step()) << world->failure();
    ends.push_back(particles_of(*world).x);
  }
  set_threads(before);
  EXPECT_EQ(ends[0], ends[1]);
}

/// A pressed chain, almost straight: as it buckles its forces grow before they find their balance.
ProjectiveSystem buckling_chain() {
  constexpr int kLinks = 8;
  constexpr double kEdge = 0.02;
  Positions x = Positions::Zero(3, kLinks + 1);
  std::vector<Spring> springs;
  for (int i = 0; i <= kLinks; ++i) {
    x.col(i) << kEdge * i, i % kLinks == 0 ? 0.0 : 0.01 * kEdge, 0.0;
    if (i > 0) springs.push_back({i - 1, i, 1.2 * kEdge, 1000.0});
  }
  ProjectiveSystem system = system_at(x);
  system.elements.push_back(std::make_unique<SpringSet>("stretch", springs, kLinks + 1));
  system.particles.fix(0);
  system.particles.fix(kLinks);
  return system;
}

TEST(DeviceJacobi, EndsWithItsLastIterateAsOnTheCpu) {
  constexpr int kCount = 17;
  const StepProblem problem = {"chain", buckling_chain, 0.02};
  const ProjectiveSystem first = after_step(problem, "jacobi", iterations(1)),
                         exact = after_step(problem, "jacobi", iterations(kCount));
  EXPECT_GT(unbalanced_after(exact, problem.dt).norm(), unbalanced_after(first, problem.dt).norm());
  ProjectiveSystem system = problem.make();
  device_step(system, "jacobi", kCount, problem.dt);
  const Positions& x = exact.particles.x;
  const double round_off = 10.0 * single_round_off(x, kCount);  // it grows with the forces
  EXPECT_LE((system.particles.x - x).cwiseAbs().maxCoeff(), round_off);
  EXPECT_GT((first.particles.x - x).cwiseAbs().maxCoeff(), 5.0 * round_off) << "it tests nothing";
}

TEST(DeviceMatrix, StopsAtTheTolerance) {
  const StepProblem problem = step_problems()[1];  // stiff
  for (const char* name : {"line_search_jacobi", "gauss_seidel", "hybrid", "lbfgs"}) {
    ProjectiveSystem system = problem.make();
    const auto solver = make_host_device_solver(name, {1000, 1e-3, 0.0});
    solver->prepare(system, problem.dt);
    const StepReport report = step_of(system, *solver, problem.dt);
    EXPECT_EQ(report.ended_by, EndedBy::kTolerance) << name;
    EXPECT_LE(report.residual, 1e-3);
    EXPECT_LT(report.iterations, 200) << name;
  }
}

/// The message with which a device refuses to step a system; empty where it does not.
std::string refusal(const DeviceSolverSpec& spec, const ProjectiveSystem& system) {
  try {
    make_host_device_solver(spec)->prepare(const_cast<ProjectiveSystem&>(system), 0.005);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(DeviceMatrix, WhatTheCpuAloneComputesIsRefusedByName) {
  // A net in which everybody meets everybody: as many colours as particles.
  Random random(5);
  ProjectiveSystem dense = system_at(random.positions(70, 0.2));
  std::vector<Spring> springs;
  for (int i = 0; i < 70; ++i) {
    for (int j = 0; j < i; ++j) springs.push_back({i, j, 0.1, 1.0});
  }
  dense.elements.push_back(std::make_unique<SpringSet>("stretch", springs, 70));
  const StopRule rule{10, 0.0, 0.0};
  const std::string colors = refusal(device_solver_spec("gauss_seidel", rule), dense);
  EXPECT_NE(colors.find("70 colours"), std::string::npos) << colors;
  EXPECT_NE(colors.find("'hybrid'"), std::string::npos) << colors;
  EXPECT_EQ(refusal(device_solver_spec("hybrid", rule), dense), "");

  DeviceSolverSpec budget = device_solver_spec("hybrid", {10, 0.0, 0.01});
  EXPECT_NE(refusal(budget, dense).find("'budget'"), std::string::npos);
  DeviceSolverSpec error = device_solver_spec("hybrid", {10, 0.0, 0.0, 0.01});
  EXPECT_NE(refusal(error, dense).find("'error'"), std::string::npos);
  EXPECT_EQ(refusal(lbfgs_device_spec(rule, 8, 16), dense), "");
  EXPECT_NE(refusal(lbfgs_device_spec(rule, 9, 16), dense).find("'history'"), std::string::npos);
}

TEST(DeviceMatrix, StepsOnEndAreThoseOneByOne) {
  for (const char* name : {"line_search_jacobi", "hybrid", "lbfgs"}) {
    const auto single = draped_cloth("jacobi", {}), resident = draped_cloth("jacobi", {});
    for (World* world : {single.get(), resident.get()}) {
      // Converged: single steps and resident runs begin their iterations by rules of their own.
      body_of(*world).solver = make_host_device_solver(name, {150, 0.0, 0.0});
      world->system_changed();
      ASSERT_TRUE(world->step());
    }
    ASSERT_GE(resident->resident_limit(15), 2) << name;
    for (int k = 0; k < 15; ++k) ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->advance(15));
    const Positions& x = particles_of(*single).x;
    EXPECT_LE((particles_of(*resident).x - x).cwiseAbs().maxCoeff(), 1e-4 * 0.3) << name;
    EXPECT_GT(body_of(*resident).report.contacts, 0);
  }
}

/// Of the step, over its displacement.
double error_of(const Positions& x, const ProjectiveSystem& exact) {
  return (x - exact.particles.x).norm() / (exact.particles.x - exact.particles.x_start).norm();
}

TEST_P(DeviceMatrixStepOn, LbfgsNeedsHardlyMoreIterationsThanWithTheFactor) {
  constexpr int kCount = 6;
  const StepProblem& problem = GetParam();
  const ProjectiveSystem exact = after_converged_step(problem),
                         on_cpu = after_step(problem, "lbfgs", iterations(kCount));
  ProjectiveSystem system = problem.make();
  const StepReport report = device_step(system, "lbfgs", kCount, problem.dt);
  EXPECT_EQ(report.iterations, kCount);
  const double error = error_of(system.particles.x, exact);
  EXPECT_LE(error, 1.5 * error_of(on_cpu.particles.x, exact) + 1e-4);
  EXPECT_LT(error, 0.5 * error_of(prediction(exact, problem.dt), exact)) << "it tests nothing";
}

/// Random points, tied by springs half as long as they are apart, thrown over each other.
ProjectiveSystem crumpled_net() {
  ProjectiveSystem system = spring_net(60, 3, 2e3, 0.5, 4);
  system.particles.v *= 40.0;
  return system;
}

TEST(DeviceLbfgs, NoIterationRaisesTheObjective) {
  constexpr double kStep = 0.02;
  struct Shape {
    int history, sweeps;
  };
  double refused = 0.0;
  // Sweeps alone, and none: multigrid.
  for (const Shape& shape : {Shape{1, 1}, Shape{5, 2}, Shape{5, 16}, Shape{8, 64}, Shape{5, 0}}) {
    double last = std::numeric_limits<double>::infinity();
    for (int count = 1; count <= 24; ++count) {
      ProjectiveSystem system = crumpled_net();
      const StopRule rule = {count, 0.0, 0.0};
      const auto solver = make_host_device_solver(
          shape.sweeps == 0 ? lbfgs_device_spec(rule, shape.history)
                            : lbfgs_device_spec(rule, shape.history, shape.sweeps));
      solver->prepare(system, kStep);
      refused += metric(step_of(system, *solver, kStep), "halved_steps");
      const double objective = objective_after(system, kStep);
      EXPECT_LE(objective, last * (1.0 + 1e-6)) << shape.sweeps << " sweeps, " << count;
      last = objective;
    }
  }
  EXPECT_GT(refused, 0.0) << "the line search has nothing to do";
}

/// Of a cloth so fine for its time step that 20 iterations of chebyshev gain ten times the energy
/// that there is, as it falls onto a ball: the most elastic and kinetic energy beyond what
/// gravity gave, over that [1].
double gained_energy(const std::string& solver, int count) {
  ClothScene scene;
  scene.grid = {1.0, 1.0, 30, 30};
  scene.time_step = 0.025;
  scene.pose = at(0.02, 0.01, 0.31);
  scene.material = {{"stretch_warp", "500"}, {"stretch_weft", "500"}, {"shear", "50"}};
  scene.obstacles = {obstacle(Sphere(0.3))};
  scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "0.3"}}}};
  scene.solver = "jacobi";
  const auto world = make_world(scene);
  body_of(*world).solver = make_host_device_solver(solver, {count, 0.0, 0.0});
  world->system_changed();
  const Particles& particles = particles_of(*world);
  const auto height = [&] { return particles.mass.dot(particles.x.row(2).transpose()); };
  const double top = height();
  double most = -1.0, given = 0.0;
  for (int s = 0; s < 10; ++s) {
    EXPECT_TRUE(world->step()) << world->failure();
    given = 9.81 * (top - height());
    most = std::max(most, body_of(*world).model->system().elastic_energy() +
                              particles.kinetic_energy() - given);
  }
  EXPECT_GT(body_of(*world).report.contacts, 20);
  return most / given;
}

TEST(DeviceLbfgs, FineClothGainsNoEnergy) {
  // Without momentum that forces give chebyshev gained 500 % in it.
  EXPECT_LT(gained_energy("lbfgs", 10), 0.0);
  EXPECT_LT(gained_energy("chebyshev", 20), 0.0);
  EXPECT_GT(gained_energy("jacobi", 5), 0.01) << "it tests nothing";
}

TEST(DeviceLbfgs, RepeatsBitForBitForAnyNumberOfThreads) {
  std::vector<Positions> ends;
  const int before = threads();
  for (int count : {1, 3}) {
    set_threads(count);
    const auto world = draped_cloth("jacobi", {});
    body_of(*world).solver = make_host_device_solver("lbfgs", {12, 0.0, 0.0});
    world->system_changed();
    for (int s = 0; s < 20; ++s) ASSERT_TRUE(world->step()) << world->failure();
    EXPECT_GT(body_of(*world).report.contacts, 0);
    ends.push_back(particles_of(*world).x);
  }
  set_threads(before);
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(DeviceLbfgs, MoreIterationsThanALaunchHasAreTheSame) {
  // Asked for in pieces, and counted beforehand.
  const StepProblem problem = step_problems()[1];
  ProjectiveSystem stopped = problem.make();
  const auto solver = make_host_device_solver("lbfgs", {3000, 1e-3, 0.0});
  solver->prepare(stopped, problem.dt);
  const StepReport report = step_of(stopped, *solver, problem.dt);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  ASSERT_GT(report.iterations, 8);
  ASSERT_LT(report.iterations, 60);
  ProjectiveSystem counted = problem.make();
  device_step(counted, "lbfgs", report.iterations, problem.dt);
  EXPECT_EQ(counted.particles.x, stopped.particles.x);
}

}  // namespace
}  // namespace pliant
