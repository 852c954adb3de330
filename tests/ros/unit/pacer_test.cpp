#include "pliant/ros/running/pacer.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace pliant {
namespace {

using Clock = Pacer::Clock;
using std::chrono::milliseconds;

TEST(Pacer, KeepsToTheLimit) {
  Pacer pacer(2.0);
  pacer.restart(10.0);
  const auto start = Clock::now();
  // 0.1 s of simulated time at twice real time.
  const auto due = pacer.due(10.1);
  EXPECT_LT(due, start + milliseconds(51));
  EXPECT_GT(due, start + milliseconds(45));
}

TEST(Pacer, NeverWaitsWithoutALimit) {
  Pacer pacer(std::numeric_limits<double>::infinity());
  EXPECT_LT(pacer.due(1e9), Clock::now());
}

TEST(Pacer, ForgivesALag) {
  Pacer pacer(1.0);
  pacer.restart(0.0);
  std::this_thread::sleep_for(milliseconds(150));
  EXPECT_LT(pacer.due(0.01), Clock::now()) << "it is late";
  EXPECT_GT(pacer.due(0.02), Clock::now()) << "but need not catch up";
}

}  // namespace
}  // namespace pliant
