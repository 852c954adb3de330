#include "pliant/ros/robot/sender_lag.h"

#include <gtest/gtest.h>

namespace pliant::sender_lag_test {
namespace {

SenderLag sender_of(double period, int messages) {
  SenderLag lag;
  for (int k = 0; k < messages; ++k) lag.add(period * k);
  return lag;
}

TEST(SenderLag, IsLongAfterTwoPeriods) {
  const SenderLag lag = sender_of(0.05, 5);
  EXPECT_FALSE(lag.is_long(0.2 + 0.1));
  EXPECT_TRUE(lag.is_long(0.2 + 0.101));
  // What has come since counts too.
  EXPECT_FALSE(lag.is_long(0.2 + 0.101, 0.25));
}

TEST(SenderLag, OfAQuickSenderIsShortForTheWayOfAMessage) {
  const SenderLag lag = sender_of(0.001, 5);
  EXPECT_FALSE(lag.is_long(0.004 + 0.05));
  EXPECT_TRUE(lag.is_long(0.004 + 0.051));
}

TEST(SenderLag, OfASenderThatIsRacedDoesNotGrow) {
  SenderLag lag = sender_of(0.01, 2);
  double time = 0.01;
  for (int k = 0; k < 100; ++k) {
    // It sends when the simulation waits for it, at the time that has come.
    for (; !lag.is_long(time); time += 0.005) {
    }
    lag.add(time);
  }
  EXPECT_NEAR(time, 0.01 + 100 * 0.055, 1e-6);
}

TEST(SenderLag, WhereOneMessageCameIsLongBeforeTheNextWouldBeginAnew) {
  EXPECT_FALSE(SenderLag().is_long(100.0)) << "nothing has come";
  EXPECT_FALSE(sender_of(0.1, 1).is_long(0.16));
  EXPECT_TRUE(sender_of(0.1, 1).is_long(0.17));
}

TEST(SenderLag, LearnsThatASenderIsSlow) {
  SenderLag lag = sender_of(0.3, 1);
  EXPECT_TRUE(lag.is_long(0.29));
  lag.give_up();
  lag.add(0.3);
  EXPECT_FALSE(lag.is_long(0.9));
  EXPECT_TRUE(lag.is_long(0.91));
}

TEST(SenderLag, IsNeverLongOfOneThatRests) {
  SenderLag lag = sender_of(0.1, 5);
  lag.give_up();
  lag.add(3.0);
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(5.0);
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(5.1);
  EXPECT_TRUE(lag.is_long(5.31)) << "it sends again";
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
  SenderLag lag = sender_of(0.1, 5);
  lag.give_up();
  EXPECT_TRUE(lag.has_stopped());
  EXPECT_FALSE(lag.is_long(100.0));
  lag.add(0.5);
  EXPECT_FALSE(lag.has_stopped());
  EXPECT_TRUE(lag.is_long(100.0));
}

TEST(SenderLag, ATimeOfAnotherRunBeginsAnew) {
  SenderLag lag = sender_of(0.1, 50);
  lag.add(0.1);
  EXPECT_FALSE(lag.is_long(0.26));
  EXPECT_TRUE(lag.is_long(0.27));
}

}  // namespace
}  // namespace pliant::sender_lag_test
