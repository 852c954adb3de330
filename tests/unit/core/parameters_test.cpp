#include "pliant/core/parameters.h"

#include <gtest/gtest.h>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

std::vector<ParameterSpec> specs() {
  return {number_parameter("rate", "1/s", "0.5", 0.0, 10.0, "a number"),
          positive_parameter("mass", "kg", "2", 5.0, "an open lower bound"),
          integer_parameter("count", "3", 1, 100, "a whole number"),
          flag_parameter("on", "true", "a flag"),
          choice_parameter("kind", "slow", {"slow", "fast"}, "a choice"),
          vector_parameter("push", "N", "[0, 0, -1]", 10.0, "a vector")};
}

Parameters parse(const ParameterText& text) { return parse_parameters(specs(), text, "here"); }

TEST(Parameters, DefaultsFillIn) {
  const Parameters p = parse({});
  EXPECT_EQ(p.number("rate"), 0.5);
  EXPECT_EQ(p.number("mass"), 2.0);
  EXPECT_EQ(p.integer("count"), 3);
  EXPECT_TRUE(p.flag("on"));
  EXPECT_EQ(p.text("kind"), "slow");
  EXPECT_EQ(p.vector("push"), Eigen::Vector3d(0, 0, -1));
}

TEST(Parameters, EveryTypeIsRead) {
  const Parameters p = parse({{"rate", " 1e-3 "},
                              {"mass", "5"},
                              {"count", "1e2"},
                              {"on", "false"},
                              {"kind", "fast"},
                              {"push", "1 -2 3e0"}});
  EXPECT_EQ(p.number("rate"), 1e-3);
  EXPECT_EQ(p.number("mass"), 5.0);
  EXPECT_EQ(p.integer("count"), 100);
  EXPECT_FALSE(p.flag("on"));
  EXPECT_EQ(p.text("kind"), "fast");
  EXPECT_EQ(p.vector("push"), Eigen::Vector3d(1, -2, 3));
}

TEST(Parameters, BoundsAreAllowedExceptOpenOnes) {
  EXPECT_EQ(parse({{"rate", "0"}}).number("rate"), 0.0);
  EXPECT_EQ(parse({{"rate", "10"}}).number("rate"), 10.0);
  expect_refusal([] { parse({{"mass", "0"}}); }, {"here", "'mass'", "a number > 0 and <= 5 [kg]"});
  EXPECT_EQ(parse({{"mass", "1e-300"}}).number("mass"), 1e-300);
}

TEST(Parameters, RefusesWhatIsNoFiniteNumber) {
  for (const char* bad : {"", "  ", "nan", "inf", "-inf", "1e999", "abc", "1 2", "1,5", "0.5s"}) {
    expect_refusal([&] { parse({{"rate", bad}}); }, {"here", "'rate'", "finite number"});
    expect_refusal([&] { parse({{"count", bad}}); }, {"here", "'count'", "finite number"});
  }
}

TEST(Parameters, RefusesWhatIsOutOfRange) {
  for (const char* bad : {"-1e-9", "10.001", "1e300"}) {
    expect_refusal(
        [&] {
          parse({{"rate", bad}});
        },
        {"here: 'rate' is '" + std::string(bad) + "'", "a number >= 0 and <= 10 [1/s]"});
  }
  for (const char* bad : {"0", "101", "2.5", "-1"}) {
    expect_refusal(
        [&] {
          parse({{"count", bad}});
        },
        {"here: 'count'", bad, "a whole number >= 1 and <= 100"});
  }
}

TEST(Parameters, RefusesBadFlagsAndChoices) {
  for (const char* bad : {"", "True", "yes", "1", "0"}) {
    expect_refusal([&] { parse({{"on", bad}}); }, {"here: 'on'", "true or false"});
  }
  expect_refusal(
      [] {
        parse({{"kind", "fsat"}});
      },
      {"here", "kind", "'fsat'", "did you mean 'fast'"});
}

TEST(Parameters, RefusesBadVectors) {
  for (const char* bad : {"", "1", "[1, 2]", "[1, 2, 3, 4]", "[9, 9, 9]", "1e200 1e200 1e200"}) {
    expect_refusal(
        [&] {
          parse({{"push", bad}});
        },
        {"here: 'push'", "three numbers [x, y, z] of length at most 10 [N]"});
  }
  expect_refusal([] { parse({{"push", "[1, nan, 3]"}}); }, {"here: 'push'", "finite number"});
  expect_refusal([] { parse({{"push", "[1, 2, 3"}}); }, {"here: 'push'", "finite number"});
}

TEST(Parameters, UnknownNamesGetTheNearestOne) {
  expect_refusal(
      [] {
        parse({{"raet", "1"}});
      },
      {"here", "unknown parameter 'raet'", "rate, mass, count, on, kind, push",
       "did you mean 'rate'?"});
}

TEST(Parameters, FormerNamesAreRefusedByThePresentOnes) {
  const std::vector<ParameterSpec> specs = {
      renamed(integer_parameter("max_substeps", "9", 1, 10, "substeps"), "max_parts")};
  expect_refusal(
      [&] {
        parse_parameters(specs, {{"max_parts", "3"}}, "there");
      },
      {"there: the parameter 'max_parts' is called 'max_substeps' now"});
  EXPECT_EQ(parse_parameters(specs, {{"max_substeps", "3"}}, "there").integer("max_substeps"), 3);
}

TEST(Parameters, WithoutDefaultTheyAreRequired) {
  const std::vector<ParameterSpec> needed = {number_parameter("a", "m", "", 0.0, 1.0, "needed")};
  expect_refusal([&] { parse_parameters(needed, {}, "there"); },
                 {"there: 'a' is missing", "a number >= 0 and <= 1 [m]"});
  EXPECT_EQ(parse_parameters(needed, {{"a", "1"}}, "there").number("a"), 1.0);
}

TEST(Parameters, AskingForAnUndeclaredOneIsOurOwnMistake) {
  EXPECT_THROW(parse({}).number("nothing"), std::logic_error);
}

TEST(RangeText, SaysWhatIsAllowed) {
  EXPECT_EQ(number_parameter("a", "m", "1", 0.0, 2.0, "").range_text(),
            "a number >= 0 and <= 2 [m]");
  EXPECT_EQ(positive_parameter("a", "m", "1", 2.0, "").range_text(), "a number > 0 and <= 2 [m]");
  EXPECT_EQ(integer_parameter("a", "1", 1, 6, "").range_text(), "a whole number >= 1 and <= 6");
  EXPECT_EQ(flag_parameter("a", "true", "").range_text(), "true or false");
  EXPECT_EQ(choice_parameter("a", "b", {"b", "c"}, "").range_text(), "one of b, c");
  EXPECT_EQ(choice_parameter("a", "b", {}, "").range_text(), "a text");
  EXPECT_EQ(vector_parameter("a", "N", "0 0 0", 3.0, "").range_text(),
            "three numbers [x, y, z] of length at most 3 [N]");
}

TEST(RangeText, LeavesOutInfiniteBounds) {
  ParameterSpec spec;
  EXPECT_EQ(spec.range_text(), "a number");
  spec.max = 4.0;
  EXPECT_EQ(spec.range_text(), "a number <= 4");
  spec.min = 1.0;
  spec.max = std::numeric_limits<double>::infinity();
  EXPECT_EQ(spec.range_text(), "a number >= 1");
}

TEST(ParseNumbers, AcceptsBracketsCommasAndSpaces) {
  EXPECT_EQ(parse_numbers("[1, 2,3]", "w"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(parse_numbers(" 1  2 ", "w"), (std::vector<double>{1, 2}));
  EXPECT_TRUE(parse_numbers("[]", "w").empty());
  expect_refusal([] { parse_numbers("1 x", "w"); }, {"w", "'x'"});
}

}  // namespace
}  // namespace pliant
