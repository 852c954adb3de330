#include "pliant/solvers/checks/error_control.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

StopRule asked(double error) {
  StopRule rule;
  rule.iterations = 10;
  rule.error = error;
  return rule;
}

TEST(ErrorControl, WithoutAnAskedErrorIterationsStay) {
  ErrorControl control(asked(0.0));
  control.learn(0.5, 10);
  EXPECT_FALSE(control.is_on());
  EXPECT_EQ(control.rule().iterations, 10);
}

TEST(ErrorControl, TakesMoreWhileTheErrorIsTooLarge) {
  ErrorControl control(asked(0.01));
  control.learn(0.5, 10);
  EXPECT_EQ(control.rule().iterations, 20);
  control.learn(0.011, 20);
  EXPECT_EQ(control.rule().iterations, 25);
}

TEST(ErrorControl, TakesFewerWhereItIsFarBelow) {
  ErrorControl control(asked(0.01));
  control.learn(0.005, 10);
  EXPECT_EQ(control.rule().iterations, 10);
  control.learn(0.001, 10);
  EXPECT_EQ(control.rule().iterations, 8);
  for (int k = 0; k < 30; ++k) control.learn(0.0, control.rule().iterations);
  EXPECT_EQ(control.rule().iterations, 1);
}

TEST(ErrorControl, IsBounded) {
  StopRule few = asked(1e-6);
  few.most_iterations = 50;
  ErrorControl bounded(few);
  for (int k = 0; k < 30; ++k) bounded.learn(1.0, bounded.rule().iterations);
  EXPECT_EQ(bounded.rule().iterations, 50);
  ErrorControl control(asked(1e-6));
  for (int k = 0; k < 30; ++k) control.learn(1.0, control.rule().iterations);
  EXPECT_EQ(control.rule().iterations, 20000);
}

TEST(ErrorControl, ChoosesATolerance) {
  // Another one whenever the error is above the asked one, or far below: half of that is aimed at.
  ErrorControl control(asked(0.02), ErrorControl::By::kTolerance);
  EXPECT_EQ(control.rule().tolerance, 0.02);
  EXPECT_EQ(control.rule().iterations, 10);
  EXPECT_EQ(control.ended_by(), EndedBy::kTolerance);
  control.learn(0.04, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.005);
  control.learn(0.015, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.005);
  control.learn(0.001, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.0075);
  EXPECT_EQ(control.rule().iterations, 10);
  control.forget();
  EXPECT_EQ(control.rule().tolerance, 0.02);
}

TEST(ErrorControl, AToleranceIsNeverAboveTheRulesOwn) {
  StopRule rule = asked(0.02);
  rule.tolerance = 1e-3;
  for (const auto by : {ErrorControl::By::kTolerance, ErrorControl::By::kTightTolerance}) {
    ErrorControl control(rule, by);
    EXPECT_EQ(control.rule().tolerance, 1e-3);
    for (int k = 0; k < 30; ++k) control.learn(0.0, 3);
    EXPECT_EQ(control.rule().tolerance, 1e-3);
    control.learn(0.04, 3);
    EXPECT_DOUBLE_EQ(control.rule().tolerance, 2.5e-4);
  }
}

TEST(ErrorControl, TolerancesAreBounded) {
  ErrorControl control(asked(0.02), ErrorControl::By::kTolerance);
  EXPECT_FALSE(control.is_at_end());
  for (int k = 0; k < 30; ++k) control.learn(1.0, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 2e-5);
  EXPECT_TRUE(control.is_at_end());
  for (int k = 0; k < 30; ++k) control.learn(0.0, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.02);
  EXPECT_FALSE(control.is_at_end());
}

TEST(ErrorControl, WithoutAnAskedErrorTheToleranceStays) {
  StopRule rule = asked(0.0);
  rule.tolerance = 1e-10;
  ErrorControl control(rule, ErrorControl::By::kTolerance);
  control.learn(0.5, 10);
  EXPECT_EQ(control.rule().tolerance, 1e-10);
}

TEST(ErrorControl, AToleranceGoesOnFromWhatWasSaved) {
  const auto by = ErrorControl::By::kTolerance;
  ErrorControl control(asked(0.02), by), other(asked(0.02), by);
  control.learn(0.04, 3);
  StateArchive numbers;
  control.save(numbers);
  other.load(numbers);
  EXPECT_DOUBLE_EQ(other.rule().tolerance, 0.005);
}

TEST(ErrorControl, ATightToleranceIsSmallerThanTheAskedError) {
  ErrorControl control(asked(0.02), ErrorControl::By::kTightTolerance);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.006);
  EXPECT_EQ(control.ended_by(), EndedBy::kTolerance);
  control.learn(0.04, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.0015);
  for (int k = 0; k < 30; ++k) control.learn(0.0, 3);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.006);
  EXPECT_EQ(control.rule().iterations, 10);
}

TEST(ErrorControl, AGivenToleranceBoundsATightOne) {
  for (const double given : {1e-3, 1e-7}) {
    StopRule rule = asked(0.02);
    rule.tolerance = given;
    ErrorControl control(rule, ErrorControl::By::kTightTolerance);
    EXPECT_DOUBLE_EQ(control.rule().tolerance, given);
    for (int k = 0; k < 30; ++k) control.learn(0.0, 3);
    EXPECT_DOUBLE_EQ(control.rule().tolerance, given);
  }
}

TEST(ErrorControl, StepsThatDoNotReachATightToleranceTakeMoreIterations) {
  StopRule rule = asked(0.02);
  rule.most_iterations = 25;
  ErrorControl control(rule, ErrorControl::By::kTightTolerance);
  control.learn(0.03, 10);
  EXPECT_EQ(control.rule().iterations, 15);
  EXPECT_DOUBLE_EQ(control.rule().tolerance, 0.006) << "another one would change nothing";
  EXPECT_FALSE(control.is_at_end());
  control.learn(0.5, 15);
  EXPECT_EQ(control.rule().iterations, 25);
  EXPECT_TRUE(control.is_at_end());
  control.learn(0.01, 25);
  EXPECT_EQ(control.rule().iterations, 25);
  for (int k = 0; k < 30; ++k) control.learn(0.001, control.rule().iterations);
  EXPECT_EQ(control.rule().iterations, 10) << "no fewer than the rule's";
}

TEST(ErrorControl, StepsThatBeganWithoutIterationsGetSome) {
  StopRule rule = asked(0.02);
  rule.iterations = 0;
  for (const auto by : {ErrorControl::By::kIterations, ErrorControl::By::kTightTolerance}) {
    ErrorControl control(rule, by);
    control.learn(0.5, 0);
    EXPECT_EQ(control.rule().iterations, 1);
  }
}

TEST(ErrorControl, ATightToleranceGoesOnFromWhatWasSaved) {
  const auto by = ErrorControl::By::kTightTolerance;
  ErrorControl control(asked(0.02), by), other(asked(0.02), by);
  control.learn(0.04, 3);
  control.learn(0.03, 10);
  StateArchive numbers;
  control.save(numbers);
  other.load(numbers);
  EXPECT_DOUBLE_EQ(other.rule().tolerance, 0.0015);
  EXPECT_EQ(other.rule().iterations, 15);
}

TEST(ErrorControl, GoesOnFromWhatWasSaved) {
  ErrorControl control(asked(0.01)), other(asked(0.01)), off(asked(0.0));
  control.learn(0.5, 10);
  StateArchive numbers;
  control.save(numbers);
  other.load(numbers);
  EXPECT_EQ(other.rule().iterations, 20);
  numbers.rewind();
  off.load(numbers);
  EXPECT_EQ(off.rule().iterations, 10);
  StateArchive nothing;
  other.load(nothing);
  EXPECT_EQ(other.rule().iterations, 20);
}

}  // namespace
}  // namespace pliant
