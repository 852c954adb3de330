// direct and lbfgs: the factor of projective dynamics, and what L-BFGS adds to it.
#include <gtest/gtest.h>

#include "pliant/math/dense_factors.h"
#include "pliant/math/symmetric_eigen.h"
#include "pliant/solvers/iterations/direct.h"
#include "pliant/solvers/iterations/lbfgs.h"
#include "pliant/solvers/iterations/step_objective.h"
#include "support/epsilon.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

/// Of the solution of A x = b by a factor: n epsilon cond(A) |x|.
double solution_error(const StepProblem& problem) {
  const ProjectiveSystem system = problem.make();
  const Eigen::MatrixXd a = dense_matrix(system, problem.dt);
  const Eigen::VectorXd values = symmetric_eigenvalues(a);
  const double condition = values.tail(1)[0] / values[0];
  return static_cast<double>(a.rows()) * kEpsilon * condition * system.particles.x.norm();
}

class LinearProblem : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, LinearProblem, testing::Values("direct", "lbfgs", "newton"),
                         test_name_of);

TEST_P(LinearProblem, IsSolvedByOneIteration) {
  const StepProblem problem = linear_problem();
  const ProjectiveSystem start = after_step(problem, "jacobi", iterations(0));
  // A (x - y) = r(y).
  const Eigen::MatrixXd a = dense_matrix(start, problem.dt);
  const Forces r = unbalanced_after(start, problem.dt);
  const Positions expected =
      start.particles.x + DenseCholesky(a).solve(Eigen::MatrixXd(r.transpose())).transpose();
  const ProjectiveSystem solved = after_step(problem, GetParam(), iterations(1));
  EXPECT_LE((solved.particles.x - expected).norm(), 2 * solution_error(problem));
}

TEST_P(LinearProblem, EndsByItsToleranceAfterOneIteration) {
  const StepProblem problem = linear_problem();
  ProjectiveSystem system = problem.make();
  const StepReport report =
      step_of(system, GetParam(), {{"iterations", "10"}, {"tolerance", "1e-9"}}, problem.dt);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  EXPECT_EQ(report.iterations, 1);
}

TEST_P(LinearProblem, EndsWhereOnlyRoundOffIsLeft) {
  const StepProblem problem = linear_problem();
  ProjectiveSystem system = problem.make();
  const StepReport report =
      step_of(system, GetParam(), {{"iterations", "40"}, {"tolerance", "0"}}, problem.dt);
  EXPECT_EQ(report.ended_by, EndedBy::kRoundOff);
  EXPECT_LE(report.iterations, 7);  // looked at before the 2nd, 4th and 8th
  EXPECT_LE(report.residual, 1e-12);
}

class ClothAtRest : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Solvers, ClothAtRest, testing::Values("direct", "lbfgs"), test_name_of);

TEST_P(ClothAtRest, TakesNoMoreIterationsThanItNeeds) {
  for (const bool is_limited : {false, true}) {
    ClothScene scene;
    scene.solver = GetParam();
    scene.solver_parameters = iterations(24);
    scene.pose = at(0, 0, 0.001);
    scene.obstacles = {obstacle(Box(Eigen::Vector3d(1, 1, 0.02)), at(0, 0, -0.01))};
    scene.effects = {{"gravity", {}}};
    if (is_limited) scene.effects.push_back({"strain_limit", {{"max", "1.01"}}});
    scene.effects.push_back({"contact", {{"thickness", "0.002"}}});
    scene.effects.push_back({"friction", {}});
    auto world = make_world(scene);
    ASSERT_TRUE(world->advance(20));
    const StepReport& report = body_of(*world).report;
    EXPECT_EQ(report.ended_by, EndedBy::kRoundOff) << is_limited;
    EXPECT_LE(report.iterations, 3) << is_limited;
    // Not by luck of that step: looked at before the 2nd and the 4th, and once more.
    for (int step = 0; step < 40; ++step) {
      ASSERT_TRUE(world->step());
      EXPECT_EQ(report.ended_by, EndedBy::kRoundOff) << is_limited << ", " << step;
      EXPECT_LE(report.iterations, 4) << is_limited << ", " << step;
    }
    EXPECT_EQ(report.contacts, particles_of(*world).size()) << is_limited;
    // It is pulled: all iterations are due again.
    particles_of(*world).v.col(0) << 0.0, 0.0, 1.0;
    ASSERT_TRUE(world->step());
    EXPECT_EQ(report.ended_by, EndedBy::kIterations) << is_limited;
  }
}

class FactorOn : public testing::TestWithParam<StepProblem> {
 protected:
  int needed(const std::string& solver, ParameterText more = {}) const {
    more["iterations"] = "20000";
    more["tolerance"] = "1e-8";
    ProjectiveSystem system = GetParam().make();
    const StepReport report = step_of(system, solver, more, GetParam().dt);
    EXPECT_EQ(report.ended_by, EndedBy::kTolerance) << solver << ": " << report.residual;
    return report.iterations;
  }
  /// Of x += A^-1 r alone, which direct leaves where that crawls.
  int needed_without_history() const {
    ProjectiveSystem system = after_step(GetParam(), "jacobi", iterations(0));
    const DenseCholesky a(dense_matrix(system, GetParam().dt));
    StepObjective objective;
    objective.prepare(system, GetParam().dt);
    objective.begin_step(system);
    StepReport report;
    Forces r;
    for (int count = 0; count < 20000; ++count) {
      objective.forces(system, r, report);
      if (objective.relative_residual(system, r, count + 1) <= 1e-8) return count;
      system.particles.x += a.solve(Eigen::MatrixXd(r.transpose())).transpose();
    }
    ADD_FAILURE() << "does not converge";
    return 20000;
  }
};
INSTANTIATE_TEST_SUITE_P(Problems, FactorOn, testing::ValuesIn(step_problems()), problem_name);

TEST_P(FactorOn, DirectIsOneLocalAndOneGlobalStep) {
  for (const int count : {0, 1, 6}) {
    const ProjectiveSystem before = after_step(GetParam(), "direct", iterations(count));
    const Eigen::MatrixXd a = dense_matrix(before, GetParam().dt);
    const Positions step =
        DenseCholesky(a)
            .solve(Eigen::MatrixXd(unbalanced_after(before, GetParam().dt).transpose()))
            .transpose();
    const ProjectiveSystem next = after_step(GetParam(), "direct", iterations(count + 1));
    EXPECT_LE((next.particles.x - before.particles.x - step).norm(), solution_error(GetParam()));
  }
}

TEST_P(FactorOn, HistoryIsNeverSlowerThanNone) {
  const int none = needed_without_history();
  EXPECT_LE(needed("direct"), none);
  for (const char* history : {"1", "5", "20"}) {
    EXPECT_LE(needed("lbfgs", {{"history", history}}), none) << history;
  }
}

TEST_P(FactorOn, TheFirstIterationOfLbfgsIsThatOfDirect) {
  // From no history, H = A^-1; its full step lowers the objective.
  const ProjectiveSystem direct = after_step(GetParam(), "direct", iterations(1));
  const ProjectiveSystem lbfgs = after_step(GetParam(), "lbfgs", iterations(1));
  EXPECT_EQ(direct.particles.x, lbfgs.particles.x);
}

TEST_P(FactorOn, ForgetsTheLastStep) {
  // The history is that of one step: a step from the same state is the same step.
  ProjectiveSystem system = GetParam().make();
  const auto solver = make_solver("lbfgs", iterations(7));
  solver->prepare(system, GetParam().dt);
  step_of(system, *solver, GetParam().dt);
  const Positions first = system.particles.x;
  system.particles = GetParam().make().particles;
  for (const auto& set : system.elements) set->reset();
  step_of(system, *solver, GetParam().dt);
  EXPECT_EQ(system.particles.x, first);
}

TEST(Direct, TakesOverAChangedSystem) {
  const StepProblem problem = step_problems()[1];
  ProjectiveSystem system = problem.make();
  const auto solver = make_solver("direct", iterations(5));
  solver->prepare(system, problem.dt);
  step_of(system, *solver, problem.dt);
  system.particles = problem.make().particles;
  system.particles.fix(20);
  solver->prepare(system, 2 * problem.dt);
  step_of(system, *solver, 2 * problem.dt);
  ProjectiveSystem fresh = problem.make();
  fresh.particles.fix(20);
  step_of(fresh, "direct", iterations(5), 2 * problem.dt);
  EXPECT_EQ(system.particles.x, fresh.particles.x);
}

TEST(Direct, ExtrapolatesWhereItCrawlsAndNowhereElse) {
  for (const StepProblem& problem : step_problems()) {
    ProjectiveSystem few = problem.make(), many = problem.make();
    const StepReport first = step_of(few, "direct", iterations(2), problem.dt);
    const StepReport report = step_of(many, "direct", iterations(100), problem.dt);
    EXPECT_EQ(metric(first, "extrapolated"), 0.0) << problem.name;
    if (problem.name == "stiff_net") {
      EXPECT_GT(metric(report, "extrapolated"), 10.0);
    }
    if (problem.name == "soft_net") {
      EXPECT_EQ(metric(report, "extrapolated"), 0.0);
    }
  }
}

TEST(Lbfgs, RefusesAHistoryOfNothing) {
  EXPECT_THROW(make_solver("lbfgs", {{"history", "0"}}), InputError);
}

}  // namespace
}  // namespace pliant
