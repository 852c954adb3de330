#include "pliant/ros/robot/joint_state_source.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace pliant
