#include "pliant/core/step/step_report.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(StepReport, BeginForgetsTheLastStep) {
  StepReport report;
  report.iterations = 7;
  report.residual = 0.5;
  report.contacts = 3;
  report.seconds = 1.0;
  report.failure = "boom";
  report.ended_by = EndedBy::kBudget;
  report.warn("damped");
  report.add_time("solve", 0.1);
  report.add_metric("restarts", 2.0);
  report.begin(4, 0.02, 0.005);
  EXPECT_EQ(report.step, 4u);
  EXPECT_EQ(report.time, 0.02);
  EXPECT_EQ(report.dt, 0.005);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(report.residual, 0.0);
  EXPECT_EQ(report.contacts, 0);
  EXPECT_EQ(report.seconds, 0.0);
  EXPECT_EQ(report.ended_by, EndedBy::kDirect);
  EXPECT_TRUE(report.phases.empty());
  EXPECT_TRUE(report.metrics.empty());
  EXPECT_TRUE(report.warnings.empty());
  EXPECT_TRUE(report.failure.empty());
}

TEST(StepReport, OnePhaseIsOneLine) {
  StepReport report;
  report.add_time("stretch", 0.25);
  report.add_time("shear", 1.0);
  report.add_time("stretch", 0.5);
  ASSERT_EQ(report.phases.size(), 2u);
  EXPECT_EQ(report.phases[0].name, "stretch");
  EXPECT_EQ(report.phases[0].seconds, 0.75);
  EXPECT_EQ(report.phases[1].seconds, 1.0);
}

TEST(StepReport, KeepsASolversFiguresInOrder) {
  StepReport report;
  report.add_metric("spectral_radius", 0.99);
  report.add_metric("restarts", 1.0);
  ASSERT_EQ(report.metrics.size(), 2u);
  EXPECT_EQ(report.metrics[0].name, "spectral_radius");
  EXPECT_EQ(report.metrics[0].value, 0.99);
  EXPECT_EQ(report.metrics[1].name, "restarts");
}

TEST(StepReport, WarnsOnce) {
  StepReport report;
  report.warn("a");
  report.warn("b");
  report.warn("a");
  EXPECT_EQ(report.warnings, (std::vector<std::string>{"a", "b"}));
}

TEST(StepReport, ScopedPhaseMeasuresItsLife) {
  StepReport report;
  {
    ScopedPhase phase(report, "sleep");
    const Timer timer;
    while (timer.seconds() < 1e-3) {
    }
  }
  ASSERT_EQ(report.phases.size(), 1u);
  EXPECT_GE(report.phases[0].seconds, 1e-3);
}

TEST(EndedBy, HasANameForEach) {
  EXPECT_EQ(to_string(EndedBy::kIterations), "iterations");
  EXPECT_EQ(to_string(EndedBy::kTolerance), "tolerance");
  EXPECT_EQ(to_string(EndedBy::kBudget), "budget");
  EXPECT_EQ(to_string(EndedBy::kDirect), "direct");
  EXPECT_EQ(to_string(EndedBy::kRoundOff), "round-off");
}

}  // namespace
}  // namespace pliant
