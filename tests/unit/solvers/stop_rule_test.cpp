// The three stopping rules, for every solver that iterates.
#include <gtest/gtest.h>

#include "pliant/solvers/projective_solver.h"
#include "support/worlds.h"
#include "unit/geometry/expect_refusal.h"

namespace pliant {
namespace {

class IterativeSolver : public EverySolver {
 protected:
  std::unique_ptr<World> world(const ParameterText& stop) const {
    ClothScene scene;
    scene.solver = GetParam();
    scene.solver_parameters = stop;
    scene.fixed = {0, 6};
    scene.effects = {{"gravity", {}}};
    return make_world(scene);
  }
};

INSTANTIATE_TEST_SUITE_P(Solvers, IterativeSolver, testing::Values("xpbd", "jacobi"), test_name_of);

TEST_P(IterativeSolver, StopsAfterItsIterations) {
  for (const int iterations : {0, 1, 2, 17}) {
    auto w = world({{"iterations", std::to_string(iterations)}});
    ASSERT_TRUE(w->step());
    const StepReport& report = body_of(*w).report;
    EXPECT_EQ(report.iterations, iterations);
    EXPECT_EQ(report.ended_by, EndedBy::kIterations);
    EXPECT_EQ(report.solver, GetParam());
  }
}

TEST_P(IterativeSolver, StopsAtItsTolerance) {
  auto w = world({{"iterations", "100000"}, {"tolerance", "1e-3"}});
  ASSERT_TRUE(w->step());
  const StepReport& report = body_of(*w).report;
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
  EXPECT_LE(report.residual, 1e-3);
  EXPECT_GT(report.iterations, 1);
  EXPECT_LT(report.iterations, 100000);
}

TEST_P(IterativeSolver, StopsAtItsBudget) {
  auto w = world({{"iterations", "1000000"}, {"budget", "2"}});
  ASSERT_TRUE(w->step());
  const StepReport& report = body_of(*w).report;
  EXPECT_EQ(report.ended_by, EndedBy::kBudget);
  EXPECT_GE(report.seconds, 2e-3);
}

TEST_P(IterativeSolver, ReportsAResidualThatFalls) {
  double last = 1.0;
  for (const char* iterations : {"5", "20", "80"}) {
    auto w = world({{"iterations", iterations}});
    ASSERT_TRUE(w->step());
    EXPECT_LT(body_of(*w).report.residual, last);
    last = body_of(*w).report.residual;
  }
}

TEST_P(IterativeSolver, RefusesBadRules) {
  expect_refusal([&] { world({{"iterations", "-1"}}); }, {"'iterations'", ">= 0"});
  expect_refusal([&] { world({{"iterations", "1.5"}}); }, {"'iterations'", "whole number"});
  expect_refusal([&] { world({{"tolerance", "2"}}); }, {"'tolerance'", "<= 1"});
  expect_refusal([&] { world({{"budget", "-1"}}); }, {"'budget'", "[ms]"});
}

TEST(StopRule, ReadsItsParameters) {
  const Parameters p = parse_parameters(
      stop_rule_parameters("10"), {{"tolerance", "0.01"}, {"budget", "5"}}, "test");
  const StopRule rule = stop_rule(p);
  EXPECT_EQ(rule.iterations, 10);
  EXPECT_EQ(rule.tolerance, 0.01);
  EXPECT_DOUBLE_EQ(rule.budget, 0.005);
}

TEST(StopCheck, NoMovementHasNoResidual) {
  StepReport report;
  const StopRule rule{10, 0.5, 0.0};
  StopCheck stop(rule, report);
  ASSERT_TRUE(stop.next());
  stop.set_displacement(0.0);
  EXPECT_FALSE(stop.next());
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
}

}  // namespace
}  // namespace pliant
