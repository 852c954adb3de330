// Chebyshev's promise: after as many iterations its step is no worse than plain Jacobi's.
#include <gtest/gtest.h>

#include "support/solvers/solvers.h"
#include "support/worlds/step_scenes.h"

namespace pliant {
namespace {

class NeverWorse : public testing::TestWithParam<StepScene> {};
INSTANTIATE_TEST_SUITE_P(Scenes, NeverWorse, testing::ValuesIn(step_scenes()),
                         [](const auto& info) { return info.param.name; });

Positions after_step(const StepScene& scene, const std::string& solver,
                     const ParameterText& parameters) {
  const auto world = world_before_step(scene, solver, parameters);
  EXPECT_TRUE(world->step());
  return particles_of(*world).x;
}

TEST_P(NeverWorse, ThanJacobiAfterAsManyIterations) {
  const StepScene& scene = GetParam();
  const Positions exact = after_step(scene, "newton", {{"tolerance", "1e-11"}});
  const auto error = [&](const char* solver, int count) {
    return (after_step(scene, solver, with_iterations(solver, count)) - exact).norm();
  };
  // What the reference leaves and round-off.
  const double slack = 1e-9 * error("jacobi", 0) + 1e-15 * exact.norm();
  for (const int count : {0, 1, 3, 5, 6, 7, 8, 10, 15, 20, 30, 60, 120, 300}) {
    EXPECT_LE(error("chebyshev", count), error("jacobi", count) + slack) << count;
  }
}

}  // namespace
}  // namespace pliant
