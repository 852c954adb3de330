#include "pliant/study/judges/judge_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "pliant/study/judges/strip_elastica.h"

namespace pliant::judge_table_test {
namespace {

Judge made_judge(const std::string& name, std::vector<JudgedFigure> (*run)(const JudgeOptions&)) {
  return {name, "a source", "a set-up", kComputed, true, run};
}

const Judge kGood = made_judge("good", [](const JudgeOptions&) {
  return std::vector<JudgedFigure>{{"near", "m", 2.0, 2.02, 2.1}, {"exact", "m", -3.0, -3.0}};
});
const Judge kBad = made_judge("bad", [](const JudgeOptions&) {
  return std::vector<JudgedFigure>{
      {"far", "N", 1.0, 1.06}, {"lost", "N", 1.0, std::nan("")}, {"farther", "N", 1.0, 0.5}};
});
const Judge kFailing = made_judge("failing", [](const JudgeOptions&) -> std::vector<JudgedFigure> {
  throw std::runtime_error("it burst");
});

std::vector<JudgedRow> run(const std::vector<const Judge*>& chosen) {
  return run_judges(chosen, "", [](double, const std::string&) { return true; });
}

TEST(JudgeTable, MissesComeFirstAndTheWorstOfThemBeforeAll) {
  std::vector<std::string> names;
  std::vector<bool> misses;
  for (const JudgedRow& row : run({&kGood, &kBad})) {
    names.push_back(row.figure.quantity);
    misses.push_back(row.is_miss());
  }

  EXPECT_EQ(names, (std::vector<std::string>{"lost", "farther", "far", "near", "exact"}));
  EXPECT_EQ(misses, (std::vector<bool>{true, true, true, false, false}));
}

TEST(JudgeTable, SaysReferenceOursAndError) {
  const std::string table = judge_table(run({&kGood}));

  EXPECT_NE(table.find("|     | good  | near   | m    | 2         | 2.02 | 1 %   | 5 %     | 5 % "),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("| -3        | -3   | 0 %   | 5 %     | - "), std::string::npos) << table;
  EXPECT_EQ(table.find("miss"), std::string::npos) << table;
  EXPECT_NE(
      judge_table(run({&kBad})).find("| **miss** | bad   | lost    | N    | 1         | none"),
      std::string::npos);
}

TEST(JudgeTable, AJudgeThatFailsIsAMissThatSaysWhy) {
  const std::vector<JudgedRow> rows = run({&kGood, &kFailing});

  ASSERT_EQ(rows.size(), 3u) << "the others are judged all the same";
  EXPECT_EQ(rows[0].judge, &kFailing);
  EXPECT_TRUE(rows[0].is_miss());
  EXPECT_NE(judge_table(rows).find("failed: it burst"), std::string::npos);
}

TEST(JudgeTable, WhatIsStoppedLeavesTheRowsOfThoseThatEnded) {
  int asked = 0;
  const auto rows =
      run_judges({&kGood, &kBad}, "", [&](double, const std::string&) { return ++asked < 2; });

  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].judge, &kGood);
}

TEST(JudgeTable, WritesAllDigitsAsCsv) {
  EXPECT_NE(judge_csv(run({&kBad})).find("bad,\"far\",N,1,1.06,0.06,0.05,nan,1,"),
            std::string::npos);
}

TEST(Judges, EachHasASourceASetUpAndANameOfItsOwn) {
  std::set<std::string> names;
  for (const Judge& judge : judges()) {
    EXPECT_TRUE(names.insert(judge.name).second) << judge.name;
    EXPECT_FALSE(judge.source.empty()) << judge.name;
    EXPECT_FALSE(judge.set_up.empty()) << judge.name;
    EXPECT_TRUE(judge.allowed == kComputed || judge.allowed == kMeasured) << judge.name;
  }
  EXPECT_GE(names.size(), 10u);
}

TEST(Judges, PeircesBendingLengthIsHalfOfTheOverhang) {
  // What the standard's angle of 41.5 degrees was chosen for.
  EXPECT_NEAR(elastica_overhang(41.5 / 180.0 * M_PI), 2.0, 0.002);
  // For small lengths the tip is w L⁴/(8 B) lower.
  EXPECT_NEAR(elastica_chord_angle(0.2), 0.001, 1e-7);
}

class QuickJudge : public testing::TestWithParam<std::string> {};

// docs/validation.md shows these errors.
TEST_P(QuickJudge, IsMetWithinTheErrorThatIsShownAndNearerTheFinerItIs) {
  const auto judge = std::find_if(judges().begin(), judges().end(),
                                  [](const Judge& one) { return one.name == GetParam(); });
  ASSERT_NE(judge, judges().end());
  EXPECT_TRUE(judge->is_quick);
  const std::vector<JudgedRow> rows = run({&*judge});
  ASSERT_FALSE(rows.empty());
  for (const JudgedRow& row : rows) {
    EXPECT_LE(row.figure.error(), 0.025) << row.figure.quantity << row.failure;
    EXPECT_LT(row.figure.error(), row.figure.coarser_error()) << row.figure.quantity;
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, QuickJudge,
                         testing::Values("torsion", "cooks_membrane", "elastic_flag_statics",
                                         "fabric_cantilever"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace pliant::judge_table_test
