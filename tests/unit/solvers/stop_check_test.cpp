#include "pliant/solvers/iterations/stop_check.h"

#include <gtest/gtest.h>

#include "support/solvers/solver_systems.h"

namespace pliant {
namespace {

TEST(StopCheck, CountsIterations) {
  StepReport report;
  const StopRule rule{3, 0.0, 0.0};
  StopCheck stop(rule, report);
  for (const int iteration : {1, 2, 3}) {
    EXPECT_TRUE(stop.next());
    EXPECT_EQ(report.iterations, iteration);
  }
  EXPECT_FALSE(stop.next());
  EXPECT_EQ(report.iterations, 3);
  EXPECT_EQ(report.ended_by, EndedBy::kIterations);
}

TEST(StopCheck, DoesNotCountAnIterationThatIsNotNeeded) {
  StepReport report;
  const StopRule rule{10, 0.1, 0.0};
  StopCheck stop(rule, report);
  ASSERT_TRUE(stop.next());
  EXPECT_FALSE(stop.converged(0.1001));
  EXPECT_EQ(report.residual, 0.1001);
  ASSERT_TRUE(stop.next());
  EXPECT_TRUE(stop.converged(0.1));
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(report.residual, 0.1);
  EXPECT_EQ(report.ended_by, EndedBy::kTolerance);
}

TEST(StopCheck, LooksForRoundOffNowAndThen) {
  StepReport report;
  const StopRule rule{20, 0.0, 0.0};
  StopCheck stop(rule, report);
  std::vector<int> looks;
  for (int k = 0; k < 17 && stop.next(); ++k) {
    if (stop.may_be_round_off()) looks.push_back(report.iterations);
  }
  EXPECT_EQ(looks, (std::vector<int>{2, 4, 8, 16}));
  stop.end_at_round_off();
  EXPECT_EQ(report.iterations, 16);
  EXPECT_EQ(report.ended_by, EndedBy::kRoundOff);
}

TEST(StopCheck, WithoutToleranceNothingIsSmallEnough) {
  StepReport report;
  const StopRule rule{10, 0.0, 0.0};
  StopCheck stop(rule, report);
  ASSERT_TRUE(stop.next());
  EXPECT_FALSE(stop.converged(0.0));
  EXPECT_EQ(report.iterations, 1);
}

TEST(StopCheck, ANonFiniteResidualIsNotConverged) {
  StepReport report;
  const StopRule rule{10, 0.5, 0.0};
  StopCheck stop(rule, report);
  ASSERT_TRUE(stop.next());
  EXPECT_FALSE(stop.converged(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(stop.converged(std::numeric_limits<double>::infinity()));
}

TEST(StopCheck, RoundOffEndsIt) {
  StepReport report;
  const StopRule rule{10, 0.0, 0.0};
  StopCheck stop(rule, report);
  ASSERT_TRUE(stop.next());
  stop.stall();
  EXPECT_FALSE(stop.next());
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(report.ended_by, EndedBy::kRoundOff);
}

TEST(StopCheck, ABudgetAllowsOneIteration) {
  StepReport report;
  const StopRule rule{10, 0.0, 1e-9};
  StopCheck stop(rule, report);
  const Timer timer;
  while (timer.seconds() < 1e-6) {
  }
  EXPECT_TRUE(stop.next());
  EXPECT_FALSE(stop.next());
  EXPECT_EQ(report.iterations, 1);
  EXPECT_EQ(report.ended_by, EndedBy::kBudget);
}

TEST(StopCheck, IterationsComeBeforeTheBudget) {
  StepReport report;
  const StopRule rule{0, 0.5, 1e-9};
  StopCheck stop(rule, report);
  EXPECT_FALSE(stop.next());
  EXPECT_EQ(report.ended_by, EndedBy::kIterations);
}

TEST(StopCheck, KnowsWhetherTheResidualIsThatOfTheEnd) {
  StepReport report;
  const StopRule rule{3, 0.0, 0.0};
  StopCheck stop(rule, report);
  EXPECT_FALSE(stop.is_residual_old());
  ASSERT_TRUE(stop.next());
  stop.converged(1.0);
  EXPECT_FALSE(stop.is_residual_old());
  ASSERT_TRUE(stop.next());
  stop.stall();
  EXPECT_FALSE(stop.next());
  EXPECT_TRUE(stop.is_residual_old());
  stop.set_residual(0.25);
  EXPECT_EQ(report.residual, 0.25);
}

/// The iterations of `rule` whose residual is measured.
std::vector<int> measured(const StopRule& rule, bool constraints) {
  StepReport report;
  StopCheck stop(rule, report);
  std::vector<int> result;
  while (stop.next()) {
    if (stop.wants_residual(constraints)) result.push_back(report.iterations);
  }
  return result;
}

TEST(StopCheck, MeasuresOnlyWhereSomebodyAsks) {
  EXPECT_EQ(measured({5, 0.0, 0.0}, false), (std::vector<int>{1, 5}));
  EXPECT_EQ(measured({5, 0.0, 0.0}, true), (std::vector<int>{1, 2, 5}));
  EXPECT_EQ(measured({5, 0.1, 0.0}, false), (std::vector<int>{1, 2, 3, 4, 5}));
  EXPECT_EQ(measured({1, 0.0, 0.0}, true), (std::vector<int>{1}));
}

/// Whether it warns after one iteration with `residual`.
bool warns_of(double residual, double tolerance, bool stalled = false) {
  StepReport report;
  const StopRule rule{1, tolerance, 0.0};
  StopCheck stop(rule, report);
  EXPECT_TRUE(stop.next());
  const bool converged = stop.converged(residual);
  if (stalled) stop.stall();
  if (!converged) stop.next();
  stop.warn_unless_converged();
  return warns(report, "not_converged");
}

TEST(StopCheck, WarnsWhereTheAskedToleranceWasNotReached) {
  EXPECT_TRUE(warns_of(0.01, 0.001));
  EXPECT_FALSE(warns_of(0.001, 0.001));
}

TEST(StopCheck, WhatRoundOffLeavesIsNoMatterOfIterations) {
  EXPECT_FALSE(warns_of(1e-8, 1e-10, true));
  EXPECT_TRUE(warns_of(1e-8, 1e-10));
  EXPECT_TRUE(warns_of(1e-3, 1e-10, true));
}

TEST(StopCheck, WithoutToleranceAResidualIsLargeWhereHalfTheForcesAreLeft) {
  const auto warned = [](double residual, double tolerance) {
    StepReport report;
    const StopRule rule{1, tolerance, 0.0};
    StopCheck stop(rule, report);
    EXPECT_TRUE(stop.next());
    stop.converged(residual);
    stop.warn_of_large_residual();
    return warns(report, "not_converged");
  };
  EXPECT_FALSE(warned(0.4, 0.0));
  EXPECT_TRUE(warned(0.6, 0.0));
  // A tolerance above a half is the user's wish.
  EXPECT_FALSE(warned(0.7, 0.8));
}

}  // namespace
}  // namespace pliant
