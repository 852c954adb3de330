// Solvers that differ only in how they iterate agree where they converge.
#include <gtest/gtest.h>

#include "support/worlds.h"

namespace pliant {
namespace {

/// A cloth on two corners after 0.1 s of falling.
Positions hanging(const std::string& solver, double dt, const ParameterText& parameters) {
  ClothScene s;
  s.solver = solver;
  s.solver_parameters = parameters;
  s.material = soft_material();
  s.material["bending"] = "1e-4";
  s.time_step = dt;
  s.fixed = {0, 6};
  s.effects = {{"gravity", {}}};
  auto world = make_world(s);
  run_for(*world, 0.1);
  return particles_of(*world).x;
}

double largest(const Positions& difference) { return difference.colwise().norm().maxCoeff(); }

const ParameterText kMany{{"iterations", "3000"}};

TEST(Agreement, ConvergedXpbdAndJacobiAreTheSameImplicitEuler) {
  // Both solve the same step; XPBD leaves out how springs turn while it iterates, h² of a step, so
  // the difference must vanish with the step, faster than the first-order error that both share.
  const double coarse = largest(hanging("xpbd", 4e-3, kMany) - hanging("jacobi", 4e-3, kMany));
  const double fine = largest(hanging("xpbd", 1e-3, kMany) - hanging("jacobi", 1e-3, kMany));
  const double step_error = largest(hanging("jacobi", 1e-3, kMany) - hanging("jacobi", 5e-4, kMany));
  EXPECT_LE(fine, 0.3 * coarse);
  EXPECT_LE(fine, 0.1 * step_error);
}

TEST(Agreement, ImplicitAndExplicitMeetAsTheStepFalls) {
  const Positions reference = hanging("verlet", 1e-5, {});
  const double coarse = largest(hanging("jacobi", 2e-3, kMany) - reference);
  const double fine = largest(hanging("jacobi", 1e-3, kMany) - reference);
  // First order: half the step, half the error.
  EXPECT_NEAR(coarse / fine, 2.0, 0.3);
}

TEST(Agreement, MoreIterationsAreCloser) {
  const Positions reference = hanging("jacobi", 2e-3, kMany);
  double last = 1e300;
  for (const char* iterations : {"5", "10", "20", "40", "80"}) {
    const double error = largest(hanging("jacobi", 2e-3, {{"iterations", iterations}}) - reference);
    EXPECT_LT(error, last) << iterations;
    last = error;
  }
  // Each iteration leaves rows / (m/h² + rows) of an error, 0.5 here at the worst.
  EXPECT_LE(last, 1e-8);
}

}  // namespace
}  // namespace pliant
