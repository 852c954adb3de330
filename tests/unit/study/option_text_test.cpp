#include "pliant/study/option_text.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

TEST(OptionText, ReadsNames) {
  EXPECT_EQ(parse_names("xpbd, jacobi", "--solvers"), (std::vector<std::string>{"xpbd", "jacobi"}));
  EXPECT_TRUE(parse_names("all", "--solvers").empty());
}

TEST(OptionText, RefusesBadNames) {
  for (const char* bad : {"", ",", "xpbd,", ",xpbd", "xpbd,,jacobi"}) {
    expect_refusal([&] { parse_names(bad, "--solvers"); }, {"--solvers", "empty item", "for"});
  }
  expect_refusal([] { parse_names("a,b,a", "--solvers"); }, {"--solvers has a twice"});
}

TEST(OptionText, ReadsAndSortsCounts) {
  EXPECT_EQ(parse_counts("8,1, 1000000,2", "--iterations"), (std::vector<int>{1, 2, 8, 1000000}));
}

TEST(OptionText, RefusesBadCounts) {
  for (const char* bad : {"", "1,", "x", "0", "-1", "1.5", "1e7", "nan", "inf", "1;2", "1,2x"}) {
    expect_refusal([&] { parse_counts(bad, "--iterations"); }, {"--iterations"});
  }
  expect_refusal([] { parse_counts("4,0", "--iterations"); }, {"has 0", "from 1 to 1000000"});
  expect_refusal([] { parse_counts("4,1,4", "--iterations"); }, {"has 4 twice"});
}

TEST(OptionText, ReadsTimeStepsLargestFirst) {
  EXPECT_EQ(parse_time_steps("0.0025,0.005", "--dt"), (std::vector<double>{0.005, 0.0025}));
}

TEST(OptionText, RefusesBadTimeSteps) {
  for (const char* bad : {"", "0", "-0.01", "2", "nan", "inf", "x", "0.1,,0.2", "1ms"}) {
    expect_refusal([&] { parse_time_steps(bad, "--dt"); }, {"--dt"});
  }
  expect_refusal([] { parse_time_steps("0.1,0", "--dt"); }, {"has 0", "> 0 and <= 1 s"});
  expect_refusal([] { parse_time_steps("0.1,0.10", "--dt"); }, {"twice"});
}

TEST(OptionText, ReadsWallTimes) {
  EXPECT_DOUBLE_EQ(parse_wall_time("16ms", "--budget"), 0.016);
  EXPECT_DOUBLE_EQ(parse_wall_time("0.5 s", "--budget"), 0.5);
  EXPECT_DOUBLE_EQ(parse_wall_time("250us", "--budget"), 250e-6);
}

TEST(OptionText, RefusesBadWallTimes) {
  for (const char* bad : {"", "16", "ms", "xms", "16m", "nan ms", "1e999s"}) {
    expect_refusal([&] { parse_wall_time(bad, "--budget"); }, {"--budget"});
  }
  expect_refusal([] { parse_wall_time("16", "--budget"); }, {"with its unit: 16ms"});
  expect_refusal([] { parse_wall_time("-1ms", "--budget"); }, {"must be > 0"});
  expect_refusal([] { parse_wall_time("0s", "--budget"); }, {"must be > 0"});
}

}  // namespace
}  // namespace pliant
