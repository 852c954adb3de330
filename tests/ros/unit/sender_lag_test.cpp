#include "pliant/ros/robot/sender_lag.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace pliant::sender_lag_test {
namespace {

constexpr double kStep = 0.005;     // of the simulation [s]
constexpr double kMargin = 1e-6;    // beyond round-off [s]
constexpr double kRacedRate = 0.5;  // simulated time in which a raced sender does not run [s]

SenderLag sender_of(double period, int messages) {
  SenderLag lag;
  for (int k = 0; k < messages; ++k) lag.add(period * k);
  return lag;
}

/// A simulation that goes as fast as it can beside a sender that sends each `period`, at once
/// where the simulation waits.
struct Race {
  SenderLag lag;
  double time = 0.0;            // [s]
  double waited_in_vain = 0.0;  // [wall s]
  double largest_lag = 0.0;     // of the last simulated second [s]

  void run(double period, double duration) {
    if (lag.newest() < 0.0) lag.add(0.0);
    for (const double end = time + duration; time < end;) {
      time += kStep;
      if (time > end - 1.0) largest_lag = std::max(largest_lag, time - lag.newest());
      while (lag.is_long(time)) {
        const double patience = lag.begin_waiting();
        if (time - lag.newest() >= period - kMargin) {
          lag.add(time);
        } else {
          waited_in_vain += patience;
          lag.give_up();
        }
      }
      // Where nobody waits for it the raced sender does not come to send.
      if (time - lag.newest() >= std::max(period, kRacedRate)) lag.add(time);
    }
  }
};

TEST(SenderLag, BeginsWithTheTimeThatAMessageTakes) {
  EXPECT_FALSE(SenderLag().is_long(100.0)) << "nothing has come";
  const SenderLag lag = sender_of(0.01, 5);
  EXPECT_FALSE(lag.is_long(0.04 + SenderLag::kLeastLag));
  EXPECT_TRUE(lag.is_long(0.04 + SenderLag::kLeastLag + kMargin));
  // What has come since counts too.
  EXPECT_FALSE(lag.is_long(0.04 + SenderLag::kLeastLag + kMargin, 0.05));
}

TEST(SenderLag, OfAQuickSenderThatIsRacedStaysTheLeast) {
  Race race;
  race.run(0.01, 20.0);
  EXPECT_EQ(race.waited_in_vain, 0.0);
  EXPECT_NEAR(race.largest_lag, SenderLag::kLeastLag + kStep, kMargin);
}

TEST(SenderLag, OfASlowSenderIsFoundByTrial) {
  for (const double period : {0.08, 0.1, 0.15, 0.3}) {
    Race race;
    race.run(period, 100.0);
    EXPECT_FALSE(race.lag.has_stopped()) << period;
    EXPECT_GE(race.largest_lag, period) << period;
    EXPECT_LE(race.largest_lag, 2.0 * period + kStep) << period;
    // Each trial in vain makes the next one four times as rare.
    EXPECT_GT(race.waited_in_vain, 0.0) << period;
    EXPECT_LE(race.waited_in_vain, 8 * SenderLag::kTrialPatience + kMargin) << period;
  }
}

TEST(SenderLag, OfAQuickSenderThatWasHeldUpGoesBackToTheLeast) {
  Race race;
  race.run(0.01, 0.002);
  for (int k = 0; k < 3; ++k) {  // the machine is busy before the first message
    race.lag.begin_waiting();
    race.lag.give_up();
  }
  EXPECT_EQ(race.lag.allowed(), 8 * SenderLag::kLeastLag);
  race.run(0.01, 60.0);
  EXPECT_EQ(race.lag.allowed(), SenderLag::kLeastLag);
  EXPECT_EQ(race.waited_in_vain, 0.0);
}

TEST(SenderLag, IsLongerWaitedForWhereItIsKnownToBeShort) {
  SenderLag lag = sender_of(0.01, 2);
  EXPECT_EQ(lag.begin_waiting(), SenderLag::kTrialPatience) << "it may have come late once";
  lag.add(0.02);
  EXPECT_EQ(lag.begin_waiting(), SenderLag::kPatience);
  lag.give_up();
  EXPECT_TRUE(lag.has_stopped());
}

TEST(SenderLag, IsNotKnownToBeShortByOneMessageInTimeAfterALateOne) {
  SenderLag lag = sender_of(0.1, 1);
  for (const double stamp : {0.19, 0.2, 0.39, 0.4}) lag.add(stamp);
  EXPECT_EQ(lag.begin_waiting(), SenderLag::kTrialPatience);
}

TEST(SenderLag, OfOneThatNeverSendsAgainEndsInAStop) {
  SenderLag lag = sender_of(0.1, 1);
  double waited = 0.0;
  int times = 0;
  for (; !lag.has_stopped(); ++times) {
    ASSERT_LT(times, 10);
    EXPECT_TRUE(lag.is_long(lag.allowed() + kMargin));
    waited += lag.begin_waiting();
    lag.give_up();
  }
  EXPECT_EQ(times, 4);  // 0.05, 0.1, 0.2, 0.4 s
  EXPECT_LE(waited, SenderLag::kPatience);
}

TEST(SenderLag, IsNeverLongOfOneThatRests) {
  SenderLag lag = sender_of(0.05, 5);
  lag.begin_waiting();
  lag.give_up();
  lag.add(3.0);
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(5.0);
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(5.1);
  EXPECT_FALSE(lag.is_long(5.2));
  EXPECT_TRUE(lag.is_long(5.21)) << "it sends again";
}

TEST(SenderLag, RepeatedAndOlderStampsSayNothing) {
  SenderLag lag = sender_of(0.01, 5);
  for (int k = 0; k < 3; ++k) lag.add(0.04);
  lag.add(0.035);
  EXPECT_EQ(lag.newest(), 0.04);
  EXPECT_FALSE(lag.is_long(0.09));
  EXPECT_TRUE(lag.is_long(0.0901));
}

TEST(SenderLag, NobodyWaitsForOneThatHasStopped) {
  SenderLag lag = sender_of(0.05, 5);
  lag.begin_waiting();
  lag.give_up();
  EXPECT_TRUE(lag.has_stopped());
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(0.5);
  EXPECT_FALSE(lag.has_stopped());
  EXPECT_TRUE(lag.is_long(100.0));
}

TEST(SenderLag, ATimeOfAnotherRunBeginsAnew) {
  SenderLag lag = sender_of(0.1, 50);
  lag.give_up();
  EXPECT_EQ(lag.allowed(), 2 * SenderLag::kLeastLag);
  lag.add(0.1);
  EXPECT_EQ(lag.newest(), 0.1);
  EXPECT_EQ(lag.allowed(), SenderLag::kLeastLag);
}

}  // namespace
}  // namespace pliant::sender_lag_test
