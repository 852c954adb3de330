#include "pliant/study/choice.h"

#include <gtest/gtest.h>

#include <limits>

namespace pliant {
namespace {

AccuracyRow row(const std::string& solver, double error, double milliseconds) {
  AccuracyRow row;
  row.solver = solver;
  row.error = error;
  row.step_seconds = 1e-3 * milliseconds;
  row.longest_seconds = 2e-3 * milliseconds;
  return row;
}

const std::vector<AccuracyRow> kRows = {row("a", 0.1, 1.0), row("b", 0.01, 5.0),
                                        row("c", 0.009, 4.0), row("d", 0.001, 20.0)};

TEST(Choice, TakesTheCheapestThatKeepsTheError) {
  EXPECT_EQ(cheapest(kRows, Measure::kStep, 0.5)->solver, "a");
  EXPECT_EQ(cheapest(kRows, Measure::kStep, 0.01)->solver, "c");
  EXPECT_EQ(cheapest(kRows, Measure::kStep, 0.005)->solver, "d");
  EXPECT_FALSE(cheapest(kRows, Measure::kStep, 1e-4));
  EXPECT_FALSE(cheapest(kRows, Measure::kRun, 0.5));
}

TEST(Choice, TheBudgetIsForTheLongestStep) {
  EXPECT_EQ(cheapest(kRows, Measure::kStep, 0.01, 0.008)->solver, "c");
  EXPECT_FALSE(cheapest(kRows, Measure::kStep, 0.01, 0.0079));
  EXPECT_EQ(most_accurate(kRows, Measure::kStep, 0.0079)->solver, "a");
  EXPECT_EQ(most_accurate(kRows, Measure::kStep, 1.0)->solver, "d");
  EXPECT_FALSE(most_accurate(kRows, Measure::kStep, 1e-4));
}

TEST(Choice, WhatTheReferencesDoNotKnowCountsAsError) {
  std::vector<AccuracyRow> rows = kRows;
  for (AccuracyRow& row : rows) row.disagreement = 0.0015;
  EXPECT_DOUBLE_EQ(sure_error(rows[3]), 0.0025);
  EXPECT_EQ(cheapest(rows, Measure::kStep, 0.01)->solver, "d");
  EXPECT_FALSE(cheapest(rows, Measure::kStep, 0.002));
}

TEST(Choice, LeavesOutWhatBlewUp) {
  std::vector<AccuracyRow> rows = {kRows[0]};
  rows[0].is_finite = false;
  rows[0].error = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(cheapest(rows, Measure::kStep, 10.0));
  EXPECT_FALSE(most_accurate(rows, Measure::kStep, 10.0));
}

TEST(Choice, RunsCostTheirTimeForASimulatedSecond) {
  std::vector<AccuracyRow> rows = {kRows[0], kRows[1]};
  for (AccuracyRow& row : rows) row.measure = Measure::kRun;
  rows[0].seconds_per_second = 3.0;
  rows[1].seconds_per_second = 2.0;
  EXPECT_EQ(cheapest(rows, Measure::kRun, 0.5)->solver, "b");
}

TEST(Choice, SnippetIsTheKeySolver) {
  EXPECT_EQ(scene_snippet({"xpbd", {{"iterations", "16"}, {"tolerance", "0.1"}}, 16}),
            "solver:\n  name: xpbd\n  iterations: 16\n  tolerance: 0.1\n");
}

}  // namespace
}  // namespace pliant
