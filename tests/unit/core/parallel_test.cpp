#include "pliant/core/parallel/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <vector>

#include "support/expect_refusal.h"

namespace pliant {
namespace {

class ParallelFor : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_threads(GetParam()); }
  void TearDown() override { set_threads(1); }
};

TEST_P(ParallelFor, VisitsEachIndexOnce) {
  for (const int size : {0, 1, 7, 64, 1000, 10007}) {
    std::vector<std::atomic<int>> visits(static_cast<std::size_t>(size));
    parallel_for(0, size, 64, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
    for (const auto& count : visits) ASSERT_EQ(count, 1);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelFor, testing::Values(1, 2, 4));

TEST(Threads, OneOrTwoAreUsual) {
  EXPECT_GE(usual_threads(), 1);
  EXPECT_LE(usual_threads(), 2);
}

TEST(Threads, AreSetAndRefused) {
  set_threads(3);
  EXPECT_EQ(threads(), 3);
  for (const int bad : {0, -1}) {
    expect_refusal([&] { set_threads(bad); }, {"threads is " + std::to_string(bad), "at least 1"});
  }
  EXPECT_EQ(threads(), 3);
  set_threads(1);
}

// The copy has the caller's thread alone: what waits for the others would never end.
TEST(Threads, ACopyOfTheProcessWorksAndEnds) {
  set_threads(2);
  const auto work = [] {
    std::vector<int> visits(1000, 0);
    parallel_for(0, 1000, 10, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
    });
    return visits == std::vector<int>(1000, 1);
  };
  EXPECT_TRUE(work());
  EXPECT_EXIT(std::exit(work() ? 0 : 1), testing::ExitedWithCode(0), "");
  const auto with_other_threads = [&] {
    set_threads(3);
    const bool worked = work();
    set_threads(1);
    std::exit(worked && work() ? 0 : 1);
  };
  EXPECT_EXIT(with_other_threads(), testing::ExitedWithCode(0), "");
  set_threads(1);
}

TEST(Threads, AreFreeUnlessALoopHasThem) {
  EXPECT_FALSE(has_free_threads());
  set_threads(2);
  EXPECT_TRUE(has_free_threads());
  parallel_for(0, 8, 1, [](int, int) { EXPECT_FALSE(has_free_threads()); });
  EXPECT_TRUE(has_free_threads());
  set_threads(1);
}

TEST(Threads, AnEmptyRangeCallsNothing) {
  parallel_for(3, 3, 1, [](int, int) { FAIL(); });
  parallel_for(5, 3, 1, [](int, int) { FAIL(); });
}

}  // namespace
}  // namespace pliant
