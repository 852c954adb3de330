// Steps that are taken again because bodies press on what moves.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "pliant/core/world.h"
#include "support/worlds/worlds.h"

namespace pliant::taken_again_test {
namespace {

/// Lowers the first obstacle, and gives half of the way back so many times a step.
class Hesitant final : public ObstacleDriver {
 public:
  Hesitant(int tries, bool fails = false) : tries_(tries), fails_(fails) {}
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    answers_ = 0;
    z_ = -0.2 * time;
    if (fails_) z_ = std::numeric_limits<double>::quiet_NaN();
    place(obstacles);
  }
  bool yields() const override { return true; }
  bool answer(const std::vector<Reaction>& reactions, bool last,
              std::vector<Obstacle>& obstacles) override {
    EXPECT_EQ(reactions.size(), obstacles.size());
    if (last) EXPECT_EQ(answers_, 4);
    if (last || answers_ == tries_) return false;
    ++answers_;
    z_ += 1e-4;
    place(obstacles);
    return true;
  }
  bool hold_back(std::vector<Obstacle>& obstacles) override {
    if (!fails_) return false;
    fails_ = false;
    z_ = 0.0;
    place(obstacles);
    return true;
  }
  int answers() const { return answers_; }

 private:
  void place(std::vector<Obstacle>& obstacles) const {
    obstacles.front().pose_end.translation().z() = z_;
  }
  int tries_, answers_ = 0;
  bool fails_;
  double z_ = 0.0;
};

/// Goes straight to where that one ends.
class Straight final : public ObstacleDriver {
 public:
  explicit Straight(double back) : back_(back) {}
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    obstacles.front().pose_end.translation().z() = time > 0.0 ? -0.2 * time + back_ : 0.0;
  }

 private:
  double back_;
};

std::unique_ptr<World> scene(const std::string& solver) {
  return make_world(falling_scene(solver, 0.01, {{"volume", "1e-4"}}));
}

class TakenAgain : public EverySolver {};
PLIANT_FOR_EVERY_SOLVER(TakenAgain);

// What was tried before leaves no trace.
TEST_P(TakenAgain, AStepEndsAsIfItWereTheFirst) {
  auto again = scene(GetParam()), straight = scene(GetParam());
  again->add_driver(std::make_unique<Hesitant>(3));
  double back = 0.0;
  for (int k = 0; k < 3; ++k) back += 1e-4;
  straight->add_driver(std::make_unique<Straight>(back));
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(again->step());
    ASSERT_TRUE(straight->step());
    ASSERT_NEAR(again->obstacles()[0].pose_end.translation().z(),
                straight->obstacles()[0].pose_end.translation().z(), 1e-15);
  }
  // The poses are the same but for round-off.
  EXPECT_LT((particles_of(*again).x - particles_of(*straight).x).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(again->steps(), 20u);
}

TEST(TakenAgain, HappensFiveTimesAtTheMost) {
  auto world = scene("xpbd");
  auto driver = std::make_unique<Hesitant>(100);
  const Hesitant& hesitant = *driver;
  world->add_driver(std::move(driver));
  ASSERT_TRUE(world->step());
  EXPECT_EQ(hesitant.answers(), 4);
  const auto& metrics = body_of(*world).report.metrics;
  const auto tries = std::find_if(metrics.begin(), metrics.end(),
                                  [](const auto& metric) { return metric.name == "tries"; });
  ASSERT_NE(tries, metrics.end());
  EXPECT_EQ(tries->value, 5.0);
}

// A step that fails is taken with what moves held back, where that is possible.
TEST(TakenAgain, AStepThatFailsIsHeldBack) {
  auto world = scene("xpbd");
  world->add_driver(std::make_unique<Hesitant>(0, true));
  EXPECT_TRUE(world->step()) << world->failure();
  EXPECT_TRUE(particles_of(*world).x.allFinite());
  EXPECT_EQ(world->obstacles()[0].pose_end.translation().z(), 0.0);
}

}  // namespace
}  // namespace pliant::taken_again_test
