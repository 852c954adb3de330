#include "pliant/ros/robot/tf_placement_source.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

constexpr char kCartUrdf[] = R"(<robot name="cart"><link name="base"/></robot>)";
constexpr double kTick = 0.005;  // [s]

/// A robot on a cart, whose transform `world` to `cart` is heard by the test.
class TfPlacementSourceTest : public testing::Test {
 protected:
  void hear(double stamp, double x) {
    geometry_msgs::TransformStamped transform;
    transform.header.stamp = ros::Time(stamp);
    transform.header.frame_id = "world";
    transform.child_frame_id = "cart";
    transform.transform.translation.x = x;
    transform.transform.rotation.w = 1.0;
    frames_->hear(transform);
  }
  double x_at(TfPlacementSource& source, double time) {
    source.place(time, placement_);
    return placement_.world_from_base.translation().x();
  }

  static double path(double time) { return 0.4 * std::sin(time); }

  /// How far the speed of a cart that tf tells of every 20 ms, now one and now four steps late, is
  /// from that of the path [m/s].
  double largest_error_of_speed(TfPlacementSource& source) {
    double error = 0.0, last = x_at(source, 0.0);
    for (int k = 1; k <= 800; ++k) {
      if (k % 8 == 0) hear(kTick * (k - 4), path(kTick * (k - 4)));
      if (k % 8 == 1 && k > 1) hear(kTick * (k - 1), path(kTick * (k - 1)));
      const double x = x_at(source, kTick * k);
      // It changes little within whatever the delay is.
      const double meant = 0.4 * std::cos(kTick * k - 0.035);
      if (k > 400) error = std::max(error, std::abs((x - last) / kTick - meant));
      last = x;
    }
    return error;
  }

  const Robot robot_ = Robot::from_text(kCartUrdf);
  std::unique_ptr<FrameTransformer> frames_ = FrameTransformer::without_listener("world");
  TfPlacementSource stamped_{robot_, "cart", true, *frames_};
  TfPlacementSource unstamped_{robot_, "cart", false, *frames_};
  Robot::Placement placement_ = robot_.initial_placement();
};

TEST_F(TfPlacementSourceTest, IsWhereTfHasItAtItsStampsHoweverUnevenlyTheyCome) {
  EXPECT_LE(largest_error_of_speed(stamped_), 0.02);
  EXPECT_EQ(stamped_.note(), "");
}

TEST_F(TfPlacementSourceTest, WithoutSimulatedStampsItGoesFromTransformToTransformAsTheyCome) {
  EXPECT_GE(largest_error_of_speed(unstamped_), 0.1);
  EXPECT_EQ(unstamped_.note(), "");
}

TEST_F(TfPlacementSourceTest, AStampOfAnotherClockIsToldAndTheLatestIsTaken) {
  x_at(stamped_, 0.0);
  x_at(stamped_, 1.0);
  hear(1.7e9, 0.5);
  double last = 0.0;
  for (int k = 1; k <= 60; ++k) {
    const double x = x_at(stamped_, 1.0 + kTick * k);
    EXPECT_LE(x - last, 1.1 * 0.5 * kTick / 0.2);
    last = x;
  }
  EXPECT_NEAR(last, 0.5, 1e-12);
  EXPECT_NE(stamped_.note().find("'cart'"), std::string::npos) << stamped_.note();
  EXPECT_NE(stamped_.note().find("use_sim_time"), std::string::npos) << stamped_.note();
}

TEST_F(TfPlacementSourceTest, ATransformAfterARestMovesItWithoutAJump) {
  hear(0.0, 0.0);
  x_at(stamped_, 0.0);
  double last = 0.0;
  for (int k = 1; k <= 400; ++k) {
    if (k == 2) hear(kTick, 0.0);
    if (k == 201) hear(1.0, 0.1);
    const double x = x_at(stamped_, kTick * k);
    EXPECT_LE(x - last, 1.1 * 0.1 * kTick / 0.2) << k;
    last = x;
  }
  EXPECT_NEAR(last, 0.1, 1e-12);
}

TEST_F(TfPlacementSourceTest, ASimulationRunsAheadOfASenderThatIsLate) {
  x_at(stamped_, 0.0);
  for (int k = 1; k <= 10; ++k) {
    hear(0.01 * k, 0.01 * k);
    x_at(stamped_, 0.01 * k);
    x_at(unstamped_, 0.01 * k);
  }
  EXPECT_FALSE(stamped_.runs_ahead(0.15));
  EXPECT_TRUE(stamped_.runs_ahead(0.16));
  EXPECT_FALSE(unstamped_.runs_ahead(10.0));
  hear(0.12, 0.12);
  EXPECT_FALSE(stamped_.runs_ahead(0.16));
  stamped_.stop_waiting(0.16);
  EXPECT_EQ(stamped_.stopped(), "") << "it was not late";
  stamped_.stop_waiting(0.18);
  EXPECT_FALSE(stamped_.runs_ahead(0.18));
  EXPECT_EQ(stamped_.stopped(), "'cart' is stamped 0.1 s in tf");
}

}  // namespace
}  // namespace pliant
