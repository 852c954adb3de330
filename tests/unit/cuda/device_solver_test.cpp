// The CUDA backend's solvers, their kernels run by the CPU: they find what the solvers of the CPU
// find, to what single precision allows.
#include <gtest/gtest.h>

#include "cuda/solvers/scenes/packed_system.h"
#include "pliant/effects/contact/contact.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/patch_worlds.h"
#include "support/worlds/step_scenes.h"

namespace pliant {
namespace {

/// Those that a device takes.
std::vector<StepProblem> packable_problems() {
  std::vector<StepProblem> problems;
  for (const StepProblem& problem : step_problems()) {
    if (why_not_packed(problem.make()).empty()) problems.push_back(problem);
  }
  return problems;
}

class DeviceStepOn : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, DeviceStepOn, testing::ValuesIn(packable_problems()),
                         problem_name);

TEST_P(DeviceStepOn, MeetsTheConvergedStep) {
  const StepProblem& problem = GetParam();
  const ProjectiveSystem exact = after_converged_step(problem);
  const double distance = (exact.particles.x - exact.particles.x_start).norm();
  for (const char* name :
       {"jacobi", "line_search_jacobi", "gauss_seidel", "hybrid", "chebyshev", "lbfgs"}) {
    ProjectiveSystem system = problem.make();
    const auto solver = make_host_device_solver(name, {5000, 0.0, 0.0});
    solver->prepare(system, problem.dt);
    const StepReport report = step_of(system, *solver, problem.dt);
    EXPECT_EQ(report.backend, "cuda");
    // A residual of a few ε_float, amplified by up to the square root of D h²/m.
    const double error = (system.particles.x - exact.particles.x).norm() / distance;
    EXPECT_LE(error, 1e-4) << name;
  }
}

/// The same world several times, all but one of them moved by device solvers. Returns how many
/// contacts were looked at in the last step.
template <class Make>
int expect_same_path(const Make& make, const StopRule& rule, int steps, double tolerance) {
  const auto exact = make("newton", ParameterText{{"iterations", "300"}, {"tolerance", "1e-9"}});
  std::vector<std::unique_ptr<World>> worlds;
  for (const char* solver : {"jacobi", "hybrid", "chebyshev", "lbfgs"}) {
    worlds.push_back(make("jacobi", ParameterText{}));
    body_of(*worlds.back()).solver = make_host_device_solver(solver, rule);
    worlds.back()->system_changed();
  }
  const Positions& x = particles_of(*exact).x;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  int contacts = 0;
  for (int s = 0; s < steps; ++s) {
    EXPECT_TRUE(exact->step()) << exact->failure();
    contacts = std::max(contacts, body_of(*exact).report.contacts);
    for (const auto& world : worlds) {
      EXPECT_TRUE(world->step()) << world->failure();
      const double off = (particles_of(*world).x - x).colwise().norm().maxCoeff();
      EXPECT_LE(off, tolerance * size) << body_of(*world).report.solver << " at step " << s;
    }
  }
  EXPECT_GT(contacts, 0);
  return static_cast<int>(effect_of<ContactEffect>(*worlds.front(), "contact").contacts().size());
}

TEST(DeviceWorld, ClothFallsOnABallWithFriction) {
  const auto make = [](const std::string& solver, const ParameterText& parameters) {
    ClothScene scene;
    scene.pose = at(0.02, 0.01, 0.105);
    scene.material = {{"stretch_warp", "50"}, {"stretch_weft", "50"}, {"shear", "5"}};
    scene.obstacles = {obstacle(Sphere(0.1))};
    scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "0.4"}}}};
    scene.solver = solver;
    scene.solver_parameters = parameters;
    return make_world(scene);
  };
  expect_same_path(make, {3000, 1e-5, 0.0}, 20, 1e-4);
}

TEST(DeviceWorld, ContactsThatMoreThanOneBlockSharesOut) {
  const auto make = [](const std::string& solver, const ParameterText& parameters) {
    PatchScene scene = falling_block(solver, parameters);
    scene.options = {{"contact_spacing", "0.005"}};
    scene.pose = at(0, 0, 0.0501);
    return make_world(scene);
  };
  EXPECT_GT(expect_same_path(make, {3000, 1e-5, 0.0}, 2, 1e-4), 256);
}

TEST(DeviceWorld, SlowModesDoNotStallWhereAnIterationGoesLessThanAQuantum) {
  const auto cpu =
      make_world(falling_ball("chebyshev", {{"iterations", "4000"}, {"tolerance", "1e-8"}}));
  const auto device = make_world(falling_ball("chebyshev", {}));
  body_of(*device).solver = make_host_device_solver("chebyshev", {2000, 1e-6, 0.0});
  device->system_changed();
  for (int s = 0; s < 8; ++s) {
    ASSERT_TRUE(cpu->step()) << cpu->failure();
    ASSERT_TRUE(device->step()) << device->failure();
  }
  EXPECT_GT(body_of(*cpu).report.contacts, 3);
  const Positions& x = particles_of(*cpu).x;
  const double size = (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  // Eight steps, each off by what single precision leaves of a strain: 6e-8. Displacements of less
  // than half a quantum that are lost make it 3e-6.
  EXPECT_LE((particles_of(*device).x - x).colwise().norm().maxCoeff(), 8 * 6e-8 * size);
}

TEST(DeviceWorld, ABlockFallsOnAPlane) {
  const auto make = [](const std::string& solver, const ParameterText& parameters) {
    PatchScene scene = falling_block(solver, parameters);
    scene.effects.push_back({"friction", {}});
    return make_world(scene);
  };
  expect_same_path(make, {3000, 1e-5, 0.0}, 20, 1e-4);
}

}  // namespace
}  // namespace pliant
