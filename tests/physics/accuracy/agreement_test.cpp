// Solvers that differ only in how they iterate agree where they converge.
#include <gtest/gtest.h>

#include "support/worlds/worlds.h"

namespace pliant::agreement_test {
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

class ConvergedSolver : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(ConvergedSolver);

TEST_P(ConvergedSolver, IsImplicitEuler) {
  const double h = 1e-3;
  const Positions reference = hanging("jacobi", h, kMany);
  const double difference = largest(hanging(solver(), h, converged(solver())) - reference);
  if (solver() != "xpbd") {
    // The same minimum in each of 100 steps; positions round by 1e-16 m, which over h is a
    // velocity, and the velocities' errors add up to n² of it.
    EXPECT_LE(difference, 100 * 100 * 1e-15);
    return;
  }
  // XPBD leaves out how springs turn while it iterates, h² of a step, so that the difference
  // vanishes with the step, faster than the first-order error that both share.
  const double coarse = largest(hanging("xpbd", 4 * h, kMany) - hanging("jacobi", 4 * h, kMany));
  EXPECT_LE(difference, 0.3 * coarse);
  EXPECT_LE(difference, 0.1 * largest(reference - hanging("jacobi", 0.5 * h, kMany)));
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
  for (const char* iterations : {"1", "2", "4", "8", "16"}) {
    const double error = largest(hanging("jacobi", 2e-3, {{"iterations", iterations}}) - reference);
    EXPECT_LT(error, last) << iterations;
    last = error;
  }
  // Each iteration leaves rows / (m/h² + rows) of an error, 0.5 here at the worst.
  EXPECT_LE(last, 1e-8);
}

}  // namespace
}  // namespace pliant::agreement_test
