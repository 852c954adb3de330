#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pliant {

/// Defects that are known and not cured yet: "suite.test/solver" and what is seen. Their tests are
/// skipped with that text, never counted as passed. Who cures one takes its line away.
inline const char* known_defect() {
  struct Defect {
    const char* test;
    const char* seen;
  };
  static const std::vector<Defect> defects = {
      {"Solvers/PayPerEffect.AStepWithEveryEffectAllocatesNothing/newton",
       "its lists grow for as long as contacts become more"},
      {"Solvers/PayPerEffect.AStepWithEveryEffectAllocatesNothing/gauss_seidel",
       "the error estimate's lists grow with the number of contacts"},
      {"Solvers/PayPerEffect.AStepWithEveryEffectAllocatesNothing/hybrid",
       "the error estimate's lists grow with the number of contacts"},
      {"Solids/OwnSettings.AGrippedBallIsFeltByItsWeight/jacobi_1e8",
       "contact forces alternate between 0 and 660 N, it slips, and no estimate sees it"},
      {"Solids/OwnSettings.AGrippedBallIsFeltByItsWeight/weighted_jacobi_1e8",
       "contact forces alternate between 0 and 660 N, it slips, and no estimate sees it"},
  };
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  const std::string name = std::string(info->test_suite_name()) + "." + info->name();
  for (const Defect& defect : defects) {
    if (name == defect.test) return defect.seen;
  }
  return nullptr;
}

}  // namespace pliant
