#include "pliant/solvers/device/backend.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "pliant/solvers/device/backend_choice.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/projective_model.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

/// A cloth that hangs by two corners, with what the CPU alone computes if asked for.
std::unique_ptr<World> hanging(bool with_air = false) {
  ClothScene scene;
  scene.fixed = {0, 6};
  scene.effects = {{"gravity", {}}};
  if (with_air) {
    scene.obstacles = {obstacle(Plane())};
    scene.effects.insert(scene.effects.end(), {{"contact", {}}, {"air", {}}});
  }
  scene.solver = "jacobi";
  return make_world(scene);
}

/// A device that works until it has made `steps`, then is lost.
class LosesDevice final : public Solver {
 public:
  explicit LosesDevice(int steps) : steps_(steps) {}
  std::string_view name() const override { return "jacobi"; }
  void prepare(System& system, double dt) override { solver_->prepare(system, dt); }
  void step(System& system, double dt, StepReport& report) override {
    solver_->step(system, dt, report);
    if (--steps_ >= 0) return;
    system.particles.x.setConstant(7.0);
    throw DeviceFailure("device lost");
  }

 private:
  std::unique_ptr<Solver> solver_ = make_host_device_solver("jacobi", {50, 0.0, 0.0});
  int steps_;
};

/// Warnings of a report that speak of the backend.
std::vector<std::string> backend_warnings(const StepReport& report) {
  std::vector<std::string> found;
  for (const std::string& warning : report.warnings) {
    if (warning.find("backend_cpu") == 0) found.push_back(warning);
  }
  return found;
}

constexpr int kIterations = 50;
std::unique_ptr<Solver> cpu() { return make_solver("jacobi"); }

TEST(Backend, WithoutADeviceTheCpuStepsAndSaysWhyOnce) {
  const auto world = hanging(), reference = hanging();
  Body& body = body_of(*world);
  body.solver = with_fallback(
      "cuda", cpu(),
      [](SolverBatch*) -> std::unique_ptr<Solver> {
        throw DeviceFailure("no GPU; configure with -DPLIANT_CUDA=ON");
      },
      kIterations);
  world->system_changed();
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_TRUE(reference->step());
    ASSERT_EQ(backend_warnings(body.report).size(), k == 0 ? 1u : 0u);
    EXPECT_EQ(body.report.backend, "cpu");
    if (k == 0) {
      EXPECT_NE(backend_warnings(body.report)[0].find("-DPLIANT_CUDA=ON"), std::string::npos);
    }
  }
  world->system_changed();  // the same reason again is no news
  ASSERT_TRUE(world->step());
  ASSERT_TRUE(reference->step());
  EXPECT_TRUE(backend_warnings(body.report).empty());
  EXPECT_EQ(particles_of(*world).x, particles_of(*reference).x);
}

TEST(Backend, AutoSaysNothingOfTheCpu) {
  const auto world = hanging();
  body_of(*world).solver = with_fallback(
      "auto", cpu(), [](SolverBatch*) -> std::unique_ptr<Solver> { throw DeviceFailure("no GPU"); },
      kIterations);
  world->system_changed();
  ASSERT_TRUE(world->step());
  EXPECT_TRUE(backend_warnings(body_of(*world).report).empty());
  EXPECT_EQ(body_of(*world).report.backend_reason, "no GPU");
}

TEST(Backend, ALostDeviceKeepsTheState) {
  const auto world = hanging(), reference = hanging();
  Body& body = body_of(*world);
  body.solver = with_fallback(
      "cuda", cpu(), [](SolverBatch*) { return std::make_unique<LosesDevice>(2); }, kIterations);
  world->system_changed();
  for (int k = 0; k < 2; ++k) {
    ASSERT_TRUE(world->step());
    EXPECT_EQ(body.report.backend, "cuda");
  }
  particles_of(*reference) = particles_of(*world);
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_TRUE(reference->step());
    EXPECT_EQ(body.report.backend, "cpu");
    ASSERT_EQ(backend_warnings(body.report).size(), k == 0 ? 1u : 0u);
    EXPECT_EQ(particles_of(*world).x, particles_of(*reference).x) << k;
  }
}

TEST(Backend, WhatTheGpuCannotTakeIsRefusedByNameAndChangesNothing) {
  const auto world = hanging(true);
  Body& body = body_of(*world);
  const auto make = [](SolverBatch*) { return make_host_device_solver("jacobi", {50, 0.0, 0.0}); };
  const auto solver = with_fallback("cuda", cpu(), make, kIterations);
  try {
    solver->prepare(body.model->system(), world->time_step());
    FAIL() << "air was taken";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("'air'"), std::string::npos) << message;
    EXPECT_NE(message.find("'auto'"), std::string::npos) << message;
  }
  const auto willing = with_fallback("auto", cpu(), make, kIterations);
  willing->prepare(body.model->system(), world->time_step());
  EXPECT_TRUE(world->step());
}

TEST(Backend, BudgetsAreForTheCpu) {
  const auto world = hanging();
  const auto solver = with_fallback(
      "cuda", cpu(),
      [](SolverBatch*) {
        return make_host_device_solver("jacobi", {50, 0.0, 0.01});
      },
      kIterations);
  EXPECT_THROW(solver->prepare(body_of(*world).model->system(), 0.005), InputError);
}

TEST(Backend, AutoTakesWhatIsEstimatedToBeFasterAndSaysWhy) {
  const auto make = [](SolverBatch*) { return make_host_device_solver("jacobi", {50, 0.0, 0.0}); };
  ClothScene scene;
  scene.effects = {{"gravity", {}}};
  scene.solver = "jacobi";
  for (int rows : {5, 60}) {
    scene.grid = {0.3, 0.3, rows, rows};
    const auto world = make_world(scene);
    Body& body = body_of(*world);
    body.solver = with_fallback("auto", cpu(), make, kIterations);
    world->system_changed();
    ASSERT_TRUE(world->step());
    const auto& system = projective_system(*body.model);
    const BackendEstimate estimate = estimate_step(system, kIterations, 1);
    EXPECT_EQ(estimate.cuda < estimate.cpu, rows == 60);
    EXPECT_EQ(body.report.backend, rows == 60 ? "cuda" : "cpu");
    EXPECT_EQ(body.report.backend_reason, why_faster(estimate));
    EXPECT_NE(body.report.backend_reason.find(rows == 60 ? "CPU" : "GPU"), std::string::npos);
  }
}

TEST(Backend, TheEstimateKnowsWhatIterationsRead) {
  const auto world = hanging(), touching = hanging(true);
  const auto system = [](const std::unique_ptr<World>& of) -> const ProjectiveSystem& {
    return projective_system(*body_of(*of).model);
  };
  const auto estimate = [](const ProjectiveSystem& of, DeviceIteration::Kind kind, int colors) {
    return estimate_step(of, kIterations, 1, {kind, 2.0, colors});
  };
  const BackendEstimate plain = estimate_step(system(world), kIterations, 1),
                        weighted = estimate(system(world), DeviceIteration::kLineSearch, 0),
                        few = estimate(system(world), DeviceIteration::kSweep, 4),
                        many = estimate(system(world), DeviceIteration::kSweep, 0);
  EXPECT_GT(weighted.cpu, plain.cpu);
  EXPECT_GT(weighted.cuda, plain.cuda);
  EXPECT_GT(few.cuda, plain.cuda);
  EXPECT_GT(many.cuda, few.cuda) << "each colour is a launch";
  EXPECT_EQ(many.cpu, few.cpu);
  const auto quasi_newton = [&](int sweeps) {
    return estimate_step(system(world), kIterations, 1,
                         {DeviceIteration::kQuasiNewton, 1.0, 0, 5, sweeps});
  };
  EXPECT_GT(quasi_newton(16).cpu, 3.0 * plain.cpu) << "a line search and the factor";
  EXPECT_GT(quasi_newton(16).cuda, quasi_newton(8).cuda);
  EXPECT_GT(quasi_newton(1).cuda, plain.cuda);
  EXPECT_EQ(quasi_newton(16).cpu, quasi_newton(8).cpu);
  const BackendEstimate cycle = estimate_step(system(world), kIterations, 1,
                                              {DeviceIteration::kQuasiNewton, 1.0, 0, 5, 2, true});
  EXPECT_GT(cycle.cuda, quasi_newton(2).cuda);
  // With contact line_search_jacobi is jacobi.
  touching->begin_step();
  const BackendEstimate with_contact = estimate(system(touching), DeviceIteration::kLineSearch, 0);
  EXPECT_EQ(with_contact.cuda, estimate_step(system(touching), kIterations, 1).cuda);
}

TEST(Backend, UnknownOnesAreRefused) {
  EXPECT_THROW(make_solver("jacobi", {{"backend", "gpu"}}), InputError);
  EXPECT_THROW(make_solver("xpbd", {{"backend", "cuda"}}), InputError);
}

TEST(Backend, WhatWasLearnedIsReadByTheOther) {
  for (const char* name : {"jacobi", "line_search_jacobi", "hybrid", "chebyshev", "lbfgs"}) {
    const auto world = hanging();
    System& system = body_of(*world).model->system();
    const auto on_cpu = make_solver(name), again = make_solver(name);
    const auto device = make_host_device_solver(name, {30, 0.0, 0.0});
    for (Solver* solver : {on_cpu.get(), again.get(), device.get()}) solver->prepare(system, 0.005);
    StepReport report;
    for (int k = 1; k <= 3; ++k) {
      report.begin(static_cast<std::uint64_t>(k), 0.005 * k, 0.005);
      system.external_forces =
          Eigen::Vector3d(0.0, 0.0, -0.01).replicate(1, system.particles.size());
      on_cpu->step(system, 0.005, report);
    }
    // There and back again.
    StateArchive learned, passed, returned;
    on_cpu->save(learned);
    device->load(learned);
    device->save(passed);
    again->load(passed);
    again->save(returned);
    ASSERT_EQ(returned.size(), learned.size()) << name;
    // All keep when the next error is estimated, which steps are not counted yet, how large it was
    // lately and of what, how many iterations an asked one takes and down to which residual, what
    // energy was lost, of each particle how far it is off and how fast, and the same of both pieces
    // as a whole, the loose particles being one.
    const auto off = 6 * static_cast<std::size_t>(system.particles.size() + 2);
    EXPECT_EQ(learned.size(), off + (std::string(name) == "chebyshev" ? 23u : 20u));
    learned.rewind();
    for (std::size_t k = 0; k < learned.size(); ++k) EXPECT_EQ(returned.read(), learned.read());
  }
}

TEST(Backend, SwapsInMotionKeepTheState) {
  const auto world = hanging();
  Body& body = body_of(*world);
  for (const char* backend : {"cpu", "auto", "cuda", "cpu"}) {
    const Particles before = particles_of(*world);
    world->set_solver(body, solver_registry(), "chebyshev", {{"backend", backend}}, "test");
    EXPECT_EQ(particles_of(*world).x, before.x);
    EXPECT_EQ(particles_of(*world).v, before.v);
    ASSERT_TRUE(world->step());
  }
}

TEST(BackendChoice, TellsWhatIsChosenBesideWhatIsNot) {
  EXPECT_EQ(why_faster({1e-3, 4e-3}), "1 ms a step estimated beside 4 ms on the GPU");
  EXPECT_EQ(why_faster({2.4e-3, 0.31e-3}), "0.31 ms a step estimated beside 2.4 ms on the CPU");
}

TEST(BackendChoice, LbfgsSweepsInSolidsAndCyclesInSheetsUnlessTold) {
  const ProjectiveSystem solid = solid_block({1e5, 0.3, 1000.0});
  const ProjectiveSystem sheet = bending_sheet(make_grid({0.2, 0.2, 9, 9}), 1e-2);
  DeviceIteration wanted = {DeviceIteration::kQuasiNewton, 1.0, 0, 5, 2, true, 16};
  EXPECT_FALSE(iteration_for(wanted, solid).is_multigrid);
  EXPECT_EQ(iteration_for(wanted, solid).sweeps, 16);
  EXPECT_TRUE(iteration_for(wanted, sheet).is_multigrid);
  EXPECT_EQ(iteration_for(wanted, sheet).sweeps, 2);
  wanted.solid_sweeps = 0;
  EXPECT_TRUE(iteration_for(wanted, solid).is_multigrid);
}

}  // namespace
}  // namespace pliant
