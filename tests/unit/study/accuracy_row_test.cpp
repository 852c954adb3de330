#include "pliant/study/accuracy/accuracy_row.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

std::vector<AccuracyRow> rows() {
  AccuracyRow step;
  step.solver = "xpbd";
  step.time_integration = "bdf2";
  step.iterations = 16;
  step.time_step = 0.005;
  step.error = 0.1 + 0.2;  // no short decimal
  step.residual = 1e-300;
  step.step_seconds = 1.0 / 3.0;
  AccuracyRow run;
  run.measure = Measure::kRun;
  run.solver = "verlet";
  run.time_integration = "own";
  run.time_step = 0.005;
  run.is_finite = false;
  run.error = std::numeric_limits<double>::infinity();
  return {step, run};
}

TEST(AccuracyRow, ComesBackFromCsv) {
  const std::string text = to_csv(rows());
  EXPECT_EQ(text.substr(0, 53), "measure,solver,time_integration,iterations,status,dt_");
  EXPECT_NE(text.find("\nstep,xpbd,bdf2,16,ok,"), std::string::npos) << text;
  EXPECT_NE(text.find("\nrun,verlet,own,,not_finite,0.005,inf,"), std::string::npos) << text;
  const std::vector<AccuracyRow> back = rows_from_csv(text, "a.csv");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_EQ(to_csv(back), text);
  EXPECT_EQ(back[0].time_integration, "bdf2");
  EXPECT_EQ(back[0].error, 0.1 + 0.2);
  EXPECT_EQ(back[0].step_seconds, 1.0 / 3.0);
  EXPECT_EQ(back[1].measure, Measure::kRun);
  EXPECT_EQ(back[1].iterations, 0);
  EXPECT_FALSE(back[1].is_finite);
  EXPECT_TRUE(std::isinf(back[1].error));
}

std::string header_of(const std::string& text) { return text.substr(0, text.find('\n') + 1); }

/// Of the columns after the status.
std::string zeros() {
  std::string cells;
  for (int k = 0; k < 16; ++k) cells += ",0";
  return cells;
}

TEST(AccuracyRow, RefusesOtherTables) {
  const std::string text = to_csv(rows());
  expect_refusal([] { rows_from_csv("", "a.csv"); }, {"a.csv:1", "no table", "--out"});
  expect_refusal([] { rows_from_csv("step,time\n", "a.csv"); }, {"a.csv:1"});
  expect_refusal([&] { rows_from_csv(text + "step,xpbd\n", "a.csv"); }, {"a.csv:4", "no row"});
  std::string broken = text;
  broken.replace(broken.find("0.005"), 5, "0.o05");
  expect_refusal([&] { rows_from_csv(broken, "a.csv"); }, {"a.csv:2", "'0.o05' is no number"});
  for (const char* iterations : {"7e37", "-1", "2.5", "nan"}) {
    const std::string row = fmt::format("step,xpbd,bdf2,{},ok{}\n", iterations, zeros());
    expect_refusal([&] { rows_from_csv(header_of(text) + row, "a.csv"); },
                   {"a.csv:2", iterations, "no number of iterations"});
  }
}

TEST(AccuracyRow, IsResolvedAboveTwiceTheDisagreement) {
  AccuracyRow row;
  row.disagreement = 1e-3;
  row.error = 2e-3;
  EXPECT_FALSE(row.is_resolved());
  row.error = 2.1e-3;
  EXPECT_TRUE(row.is_resolved());
}

}  // namespace
}  // namespace pliant
