#include "pliant/ros/robot/joint_state_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>

#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr char kUrdf[] = R"(<robot name="r">
  <link name="base"/><link name="slide"/><link name="wheel"/>
  <joint name="lift" type="prismatic">
    <parent link="base"/><child link="slide"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint>
  <joint name="spin" type="continuous">
    <parent link="slide"/><child link="wheel"/><axis xyz="0 0 1"/>
  </joint>
</robot>)";

class JointStateSourceTest : public testing::Test {
 protected:
  void send(std::vector<std::string> names, std::vector<double> values) {
    sensor_msgs::JointState message;
    message.name = std::move(names);
    message.position = std::move(values);
    source_.set(message);
  }

  double lift_at(double time) {
    source_.positions(time, positions_);
    return positions_[static_cast<std::size_t>(*robot_->joint_index("lift"))];
  }

  double spin_at(double time) {
    source_.positions(time, positions_);
    return positions_[static_cast<std::size_t>(*robot_->joint_index("spin"))];
  }

  std::shared_ptr<const Robot> robot_ = std::make_shared<Robot>(Robot::from_text(kUrdf));
  JointStateSource source_{robot_};
  std::vector<double> positions_ = robot_->initial_positions();
};

TEST_F(JointStateSourceTest, KeepsInitialPositionsWithoutMessages) {
  EXPECT_EQ(lift_at(0.0), 0.0);
  EXPECT_EQ(lift_at(0.1), 0.0);
}

TEST_F(JointStateSourceTest, JumpsBeforeTheFirstStep) {
  send({"lift"}, {0.5});
  EXPECT_EQ(lift_at(0.0), 0.5);
}

TEST_F(JointStateSourceTest, MovesEvenlyOverTheLongestPeriodAfterTheFirstMessage) {
  lift_at(0.0);
  lift_at(1.0);
  send({"lift"}, {0.4});
  EXPECT_NEAR(lift_at(1.05), 0.1, 1e-12);
  EXPECT_NEAR(lift_at(1.1), 0.2, 1e-12);
  EXPECT_NEAR(lift_at(1.2), 0.4, 1e-12);
  EXPECT_NEAR(lift_at(9.0), 0.4, 1e-12);
}

TEST_F(JointStateSourceTest, FollowsAStreamWithOnePeriodOfDelay) {
  lift_at(0.0);
  // A ramp of 1 m/s in messages every 0.1 s, stepped every 0.02 s.
  double last = 0.0;
  for (int step = 1; step <= 50; ++step) {
    if (step % 5 == 0) send({"lift"}, {0.02 * step});
    const double lift = lift_at(0.02 * step);
    if (step > 20) {
      EXPECT_NEAR(lift - last, 0.02, 1e-9) << "step " << step;
    }
    last = lift;
  }
}

TEST_F(JointStateSourceTest, StartsFromWhereItIsWhenAMessageComesEarly) {
  lift_at(0.0);
  send({"lift"}, {0.4});
  EXPECT_NEAR(lift_at(0.05), 0.1, 1e-12);
  send({"lift"}, {0.0});
  const double next = lift_at(0.06);
  EXPECT_LT(next, 0.1);
  EXPECT_GT(next, 0.08);
}

TEST_F(JointStateSourceTest, TurnsTheShorterWay) {
  send({"spin"}, {3.1});
  spin_at(0.0);
  send({"spin"}, {-3.1});
  const double half = spin_at(0.1);
  EXPECT_NEAR(half, M_PI, 1e-9);
  EXPECT_NEAR(spin_at(0.2), 2.0 * M_PI - 3.1, 1e-9);
}

TEST_F(JointStateSourceTest, ResetJumpsToTheLastMessage) {
  lift_at(0.0);
  lift_at(1.0);
  send({"lift"}, {0.4});
  EXPECT_LT(lift_at(1.01), 0.1);
  EXPECT_EQ(lift_at(0.0), 0.4);
  EXPECT_EQ(lift_at(0.01), 0.4);
}

TEST_F(JointStateSourceTest, SameTimeTwiceStaysFinite) {
  lift_at(0.0);
  lift_at(0.5);
  send({"lift"}, {0.4});
  lift_at(0.51);
  send({"lift"}, {0.2});
  EXPECT_TRUE(std::isfinite(lift_at(0.51)));
  EXPECT_TRUE(std::isfinite(lift_at(0.51)));
}

TEST_F(JointStateSourceTest, RefusesBadMessagesAndChangesNothing) {
  send({"lift"}, {0.3});
  const double nan = std::nan("");
  EXPECT_THROW(send({"spin", "lift"}, {1.0, nan}), InputError);
  EXPECT_THROW(send({"lift"}, {INFINITY}), InputError);
  EXPECT_THROW(send({"lift"}, {1e300}), InputError);
  EXPECT_THROW(send({"lift", "spin"}, {0.1}), InputError);
  EXPECT_THROW(send({}, {0.1}), InputError);
  EXPECT_EQ(lift_at(0.0), 0.3);
  EXPECT_EQ(spin_at(0.0), 0.0);
}

TEST_F(JointStateSourceTest, LeavesUnknownJointsOut) {
  send({"wheel_of_another_robot", "lift"}, {7.0, 0.2});
  EXPECT_EQ(lift_at(0.0), 0.2);
}

/// A node's own clock, and a sender that stamps by it.
class StampedJointStatesTest : public JointStateSourceTest {
 protected:
  static constexpr double kStep = 0.005, kPeriod = 0.01;  // [s]

  static double path(double time) { return 0.3 * std::sin(2.0 * time); }

  void send_at(double stamp, double lift) {
    sensor_msgs::JointState message;
    message.header.stamp = ros::Time(stamp);
    message.name = {"lift"};
    message.position = {lift};
    stamped_.set(message);
  }
  double stamped_lift_at(double time) {
    stamped_.positions(time, positions_);
    return positions_[static_cast<std::size_t>(*robot_->joint_index("lift"))];
  }
  /// Steps until `end`; messages come late and in bunches: by up to `most` steps. Returns the
  /// largest difference of a step's speed from that of the path, in the last half.
  double largest_error_of_speed(double end, int most) {
    std::deque<std::pair<int, double>> waiting;  // the step in which one comes, and its stamp
    double error = 0.0, last = stamped_lift_at(0.0);
    for (int k = 1; kStep * k < end; ++k) {
      const double time = kStep * k;
      // As from the node's thread of messages: sent by what the clock showed after the last step.
      if (k % 2 == 0) {
        waiting.emplace_back(std::max(k + 1 + (k * 7919 / 2) % (most + 1),
                                      waiting.empty() ? 0 : waiting.back().first),
                             time - kStep);
      }
      while (!waiting.empty() && waiting.front().first <= k) {
        send_at(waiting.front().second, path(waiting.front().second));
        waiting.pop_front();
      }
      const double lift = stamped_lift_at(time);
      const double speed = (lift - last) / kStep;
      // Also before it knows how late messages come.
      EXPECT_LE(std::abs(speed), 1.1) << "the sender moves it at up to 0.6 m/s";
      if (time > 0.5 * end) {
        // Up to 60 ms later, and on chords of the path.
        const double delay = stamped_.delay();
        EXPECT_LE(delay, 0.06);
        const double meant = (path(time - delay) - path(time - kStep - delay)) / kStep;
        error = std::max(error, std::abs(speed - meant));
      }
      last = lift;
    }
    return error;
  }

  JointStateSource stamped_{robot_, true};
};

TEST_F(StampedJointStatesTest, GoAsTheirStampsSayHoweverUnevenlyTheyCome) {
  EXPECT_LE(largest_error_of_speed(8.0, 0), 0.012);
}

TEST_F(StampedJointStatesTest, GoAsTheirStampsSayWhereTheyComeInBunches) {
  EXPECT_LE(largest_error_of_speed(8.0, 5), 0.012);
}

TEST_F(StampedJointStatesTest, AMessageAfterARestMovesTheJointWithinTheLongestPeriod) {
  stamped_lift_at(0.0);
  for (int k = 1; k <= 400; ++k) {
    if (k == 20) send_at(0.09, 0.0);
    if (k == 201) send_at(1.0, 0.1);
    const double lift = stamped_lift_at(kStep * k);
    if (k <= 201) {
      EXPECT_EQ(lift, 0.0) << k;
    }
    if (k == 222) {
      EXPECT_NEAR(lift, 0.05, 0.01);
    }
    if (k > 201 + 45) {
      EXPECT_NEAR(lift, 0.1, 1e-12) << k;
    }
  }
  EXPECT_EQ(stamped_.note(), "");
}

TEST_F(StampedJointStatesTest, BeginWithoutAJump) {
  stamped_lift_at(0.0);
  stamped_lift_at(1.0);
  send_at(1.0, 0.2);
  double last = 0.0;
  for (int k = 1; k <= 60; ++k) {
    const double lift = stamped_lift_at(1.0 + kStep * k);
    EXPECT_LE(std::abs(lift - last), 1.1 * 0.2 * kStep / 0.2);
    last = lift;
  }
  EXPECT_NEAR(last, 0.2, 1e-12);
}

TEST_F(StampedJointStatesTest, ATimeOfAnotherClockIsToldAndMessagesCountAsTheyCome) {
  stamped_lift_at(0.0);
  stamped_lift_at(1.0);
  send_at(1.7e9, 0.4);
  EXPECT_NEAR(stamped_lift_at(1.05), 0.1, 1e-12);
  EXPECT_NE(stamped_.note().find("use_sim_time"), std::string::npos) << stamped_.note();
  EXPECT_NEAR(stamped_lift_at(1.2), 0.4, 1e-12);
  // One that does not know the simulated time minds no stamps.
  EXPECT_EQ(source_.note(), "");
}

TEST_F(StampedJointStatesTest, AResetForgetsWhatTheRunBeforeSaid) {
  EXPECT_LE(largest_error_of_speed(1.0, 0), 1.0);
  stamped_lift_at(0.0);
  send_at(0.995, 0.9);  // it was under way
  const double first = stamped_lift_at(0.005);
  EXPECT_NEAR(first, path(0.985), 0.02);
  send_at(0.005, 0.1);
  stamped_lift_at(0.01);
  EXPECT_NEAR(stamped_lift_at(0.3), 0.1, 1e-12);
  EXPECT_EQ(stamped_.note(), "");
}

TEST_F(StampedJointStatesTest, ASimulationRunsAheadOfASenderThatIsLate) {
  stamped_lift_at(0.0);
  for (int k = 1; k <= 10; ++k) {
    send_at(0.01 * k, 0.01 * k);
    stamped_lift_at(0.01 * k);
  }
  EXPECT_FALSE(stamped_.runs_ahead(0.15));
  EXPECT_TRUE(stamped_.runs_ahead(0.16));
  // Of another robot.
  sensor_msgs::JointState other;
  other.header.stamp = ros::Time(0.155);
  other.name = {"elbow"};
  other.position = {1.0};
  stamped_.set(other);
  EXPECT_TRUE(stamped_.runs_ahead(0.16));
  // It has come, though no step has met it.
  send_at(0.12, 0.12);
  EXPECT_FALSE(stamped_.runs_ahead(0.16));
  EXPECT_TRUE(stamped_.runs_ahead(0.18));
  stamped_.stop_waiting();
  EXPECT_FALSE(stamped_.runs_ahead(0.3));
  EXPECT_TRUE(stamped_.lag().has_stopped());
  // A run that begins anew has met no message.
  send_at(0.2, 0.2);
  stamped_lift_at(0.3);
  EXPECT_TRUE(stamped_.runs_ahead(0.5));
  stamped_lift_at(0.0);
  EXPECT_FALSE(stamped_.runs_ahead(0.5));
}

TEST_F(StampedJointStatesTest, ASimulationWaitsForTheSecondMessageWhereOneCameBeforeTheFirstStep) {
  send_at(0.0, 0.1);
  stamped_lift_at(0.0);
  EXPECT_FALSE(stamped_.runs_ahead(0.05));
  EXPECT_TRUE(stamped_.runs_ahead(0.06));
}

TEST_F(StampedJointStatesTest, ASimulationWaitsForNobodyWhereItSetsNoTime) {
  lift_at(0.0);
  for (int k = 1; k <= 10; ++k) {
    send({"lift"}, {0.01 * k});
    lift_at(0.01 * k);
  }
  EXPECT_FALSE(source_.runs_ahead(10.0));
}

}  // namespace
}  // namespace pliant
