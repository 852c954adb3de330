// Newton's method: as fast as it should be near the solution, and safe away from it.
#include "pliant/solvers/iterations/newton.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/elements/cloth/spring_set.h"
#include "support/solvers/matrices.h"
#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

class NewtonOn : public testing::TestWithParam<StepProblem> {};
INSTANTIATE_TEST_SUITE_P(Problems, NewtonOn, testing::ValuesIn(step_problems()), problem_name);

TEST_P(NewtonOn, ConvergesQuadratically) {
  for (const double dt : {GetParam().dt, 4 * GetParam().dt}) {
    const StepProblem problem{GetParam().name, GetParam().make, dt};
    const Positions exact = after_converged_step(problem).particles.x;
    std::vector<double> errors;
    for (int count = 0; count < 30; ++count) {
      ParameterText parameters = iterations(count);
      parameters["tolerance"] = "0";
      errors.push_back((after_step(problem, "newton", parameters).particles.x - exact).norm());
      if (errors.back() < 1e-13) break;
    }
    EXPECT_LT(errors.back(), 1e-13) << dt;
    // Near the solution, a millimetre on bodies of 20 cm, each error is of the order of the last
    // one's square, down to round-off.
    int seen = 0;
    for (std::size_t k = 0; k + 1 < errors.size(); ++k) {
      if (errors[k] > 1e-3 || errors[k] < 1e-9) continue;
      ++seen;
      EXPECT_LE(errors[k + 1], std::max(std::pow(errors[k] / 0.2, 1.7), 1e-13)) << k;
    }
    // What only bends is linear: one iteration.
    if (GetParam().name != "bending") {
      EXPECT_GE(seen, 1) << dt;
    }
  }
}

TEST_P(NewtonOn, EndsByItsOwnTolerance) {
  ProjectiveSystem system = GetParam().make();
  const StepReport report = step_of(system, "newton", {}, GetParam().dt);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_LE(report.iterations, 20);
  EXPECT_TRUE(report.warnings.empty());
}

TEST_P(NewtonOn, RoundOffEndsItWhenNobodyElseDoes) {
  ProjectiveSystem system = GetParam().make();
  const StepReport report =
      step_of(system, "newton", {{"tolerance", "0"}, {"iterations", "1000"}}, GetParam().dt);
  EXPECT_EQ(report.ended_by, EndedBy::kRoundOff);
  EXPECT_LT(report.iterations, 50);
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_TRUE(report.warnings.empty());
}

/// Springs pressed to two thirds of their lengths, in a step in which inertia hardly counts.
StepProblem pressed_net() {
  return {"pressed",
          [] {
            ProjectiveSystem system = spring_net(40, 2, 3e3, 1.5);
            system.particles.fix(0);
            system.particles.fix(7);
            return system;
          },
          0.05};
}

TEST(Newton, ProjectsTheHessianWhereItIsIndefinite) {
  const StepProblem problem = pressed_net();
  // It is indefinite there.
  const ProjectiveSystem start = after_step(problem, "jacobi", iterations(0));
  const int n = start.particles.size();
  DenseStiffness exact(n), projected(n);
  for (const auto& set : start.elements) {
    set->add_stiffness(start.particles.x, Definiteness::kExact, exact);
    set->add_stiffness(start.particles.x, Definiteness::kProjected, projected);
  }
  const double inertia = start.particles.mass[0] / (problem.dt * problem.dt);
  ASSERT_LT(least_eigenvalue(exact.matrix) + inertia, 0.0);
  ASSERT_GT(least_eigenvalue(projected.matrix) + inertia, 0.0);

  ProjectiveSystem system = problem.make();
  const StepReport report = step_of(system, "newton", {}, problem.dt);
  EXPECT_GE(metric(report, "projected_hessians"), 1.0);
  EXPECT_LT(metric(report, "projected_hessians"), report.iterations);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  EXPECT_LE(objective_after(system, problem.dt), objective_after(start, problem.dt));
}

TEST(Newton, EndsAtAMinimum) {
  // Not at a saddle: where it stops, the exact Hessian is positive definite.
  const StepProblem problem = pressed_net();
  const ProjectiveSystem system = after_converged_step(problem);
  const int n = system.particles.size();
  DenseStiffness k(n);
  for (const auto& set : system.elements) {
    set->add_stiffness(system.particles.x, Definiteness::kExact, k);
  }
  std::vector<int> free;
  for (int i = 0; i < n; ++i) {
    const double inertia = system.particles.mass[i] / (problem.dt * problem.dt);
    for (int c = 0; c < 3; ++c) {
      k.matrix(3 * i + c, 3 * i + c) += inertia;
      if (!system.particles.is_fixed(i)) free.push_back(3 * i + c);
    }
  }
  EXPECT_GT(least_eigenvalue(k.matrix(free, free)), 0.0);
}

TEST(Newton, HalvesStepsThatGoTooFar) {
  // A mass thrown through its anchor by 100 times the spring's length: the full step overshoots.
  Positions x = Positions::Zero(3, 2);
  x(0, 1) = 0.01;
  const StepProblem problem{"thrown",
                            [x] {
                              ProjectiveSystem system = system_at(x, 1.0);
                              system.elements.push_back(std::make_unique<SpringSet>(
                                  "stretch", std::vector<Spring>{{0, 1, 0.01, 1e4}}, 2));
                              system.particles.fix(0);
                              system.particles.v.col(1) << -10.0, 1.0, 0.0;
                              return system;
                            },
                            0.1};
  double last = std::numeric_limits<double>::infinity();
  for (int count = 0; count < 30; ++count) {
    const double value = objective_after(after_step(problem, "newton", iterations(count)), 0.1);
    EXPECT_LE(value, last * (1.0 + 1e-14));
    last = value;
  }
  ProjectiveSystem system = problem.make();
  EXPECT_EQ(step_of(system, "newton", {}, problem.dt).ended_by, EndedBy::kTolerance);
}

TEST(Newton, TakesParticlesAtOnePlace) {
  // Springs without length have no direction and no stiffness; springs that pass through it have a
  // cusp in their energy, which takes many halved steps.
  for (const double speed : {0.0, 1.0}) {
    ProjectiveSystem system = spring_net(10, 1, 1e3, 1.0);
    system.particles.x.setZero();
    system.particles.v *= speed;
    const StepReport report = step_of(system, "newton", iterations(1000), 0.01);
    EXPECT_TRUE(system.particles.x.allFinite());
    EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  }
}

}  // namespace
}  // namespace pliant
