// What hands feel that lift a body, with every solver and few iterations: its weight, without
// creep, and the impulses that its momentum tells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "pliant/models/solver_registry.h"
#include "support/measures.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::hands_test {
namespace {

constexpr double kGravity = 9.81, kYoung = 1e5, kStep = 0.005, kDamping = 5.0;
constexpr double kLength = 0.1, kFace = 0.06 * 0.06;  // between the hands [m], that they hold [m²]
constexpr double kMass = 200.0 * 0.06 * kLength * 0.08;
constexpr double kWeight = kGravity * kMass;
constexpr int kLifted = 140, kSteps = 100;  // until it is lifted, and then

constexpr double kCreep = 1e-4;  // [m/s]

/// Two plates close on a block and lift it by 2 cm.
class ClosingHands final : public ObstacleDriver {
 public:
  /// They end at that distance from the middle [m].
  explicit ClosingHands(double end) : end_(end) {}
  static Eigen::Isometry3d start(int hand) { return at(0.0, hand == 0 ? -kStart : kStart, 0.0411); }
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    const double closed = std::clamp((time - 0.05) / 0.15, 0.0, 1.0);
    const double lifted = std::clamp((time - 0.2) / 0.2, 0.0, 1.0);
    for (const int hand : {0, 1}) {
      const double inwards = closed * (kStart - end_);
      const Eigen::Translation3d move(0.0, hand == 0 ? inwards : -inwards, 0.02 * lifted);
      obstacles[static_cast<std::size_t>(hand)].pose_end = move * start(hand);
    }
  }

 private:
  static constexpr double kStart = 0.062;  // [m]
  double end_;
};

/// Solver, iterations.
using Case = std::tuple<std::string, int>;

class Hands : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    if (const char* seen = known_defect()) GTEST_SKIP() << "known defect: " << seen;
    const auto& [solver, iterations] = GetParam();
    PatchScene s;
    s.solver = solver;
    s.solver_parameters = {{"iterations", std::to_string(iterations)}};
    s.kind = "block";
    s.size = {{"size", "[0.06, 0.1, 0.08]"}, {"cells", "[2, 4, 3]"}};
    s.options = {};
    s.pose = at(0, 0, 0.0406);
    s.material = {{"young", std::to_string(kYoung)}, {"poisson", "0.3"}, {"density", "200"}};
    s.time_step = kStep;
    for (const int hand : {0, 1}) {
      s.obstacles.push_back(
          obstacle(Box(Eigen::Vector3d(0.06, 0.02, 0.06)), ClosingHands::start(hand)));
    }
    s.obstacles.push_back(obstacle(Plane()));
    s.effects = {{"gravity", {}},
                 {"damping", {{"rate", std::to_string(kDamping)}}},
                 {"contact", {{"thickness", "0.001"}}},
                 {"friction", {{"coefficient", "1"}}}};
    world_ = make_world(s);
    // Each presses with three times the weight, half a plate and half a thickness away.
    const double depth = 0.5 * 3.0 * kWeight * kLength / (kYoung * kFace);
    world_->add_driver(std::make_unique<ClosingHands>(0.5 * kLength + 0.0105 - depth));
  }
  /// Of the hands and the floor on the block in the last step [N].
  Eigen::Vector3d force() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Reaction& reaction : world_->reactions()) sum -= reaction.force;
    return sum;
  }
  /// Of the sizes of these and the weight [N].
  double size_of_forces() const {
    double sum = kWeight;
    for (const Reaction& reaction : world_->reactions()) sum += reaction.force.norm();
    return sum;
  }
  std::unique_ptr<World> world_;
};

TEST_P(Hands, FeelTheWeightAndItsImpulses) {
  const Particles& p = particles_of(*world_);
  const Eigen::Vector3d weight(0.0, 0.0, -kWeight);
  double lifting = 0.0, height = 0.0;
  int held_back = 0;
  for (int k = 0; k < kLifted + kSteps; ++k) {
    if (k == kLifted) height = p.center_of_mass().z();
    const Eigen::Vector3d before = p.momentum();
    ASSERT_TRUE(world_->step()) << world_->failure();
    for (const int hand : {0, 1}) {
      if (k < kLifted) continue;
      lifting -= world_->reactions()[static_cast<std::size_t>(hand)].force.z() / kSteps;
    }
    // It went less far than forces would have taken it, and said so.
    if (warns(*world_, "energy_held_back")) {
      ++held_back;
      continue;
    }
    // Damping comes after the step.
    const Eigen::Vector3d after = std::exp(kDamping * kStep) * p.momentum();
    ASSERT_LT((after - before - kStep * (weight + force())).norm(), 1e-9 * kStep * size_of_forces())
        << world_->time();
  }
  EXPECT_NEAR(lifting, kWeight, 0.02 * kWeight);
  EXPECT_GT(p.center_of_mass().z(), 0.0406 + 0.015) << "it was not lifted";
  EXPECT_LT(held_back, 8);
  if (std::get<1>(GetParam()) >= 10) {
    EXPECT_LT(std::abs(p.center_of_mass().z() - height), kCreep * kSteps * kStep);
  }
}

/// With fewer.
class HandsInHaste : public Hands {};

TEST_P(HandsInHaste, DoNotLetItCreep) {
  run_for(*world_, kLifted * kStep);
  const Particles& p = particles_of(*world_);
  const double height = p.center_of_mass().z();
  EXPECT_GT(height, 0.0406 + 0.015) << "it was not lifted";
  run_for(*world_, kSteps * kStep);
  EXPECT_LT(std::abs(p.center_of_mass().z() - height), kCreep * kSteps * kStep);
}

const std::vector<std::string> kSolvers = {"xpbd",         "jacobi", "line_search_jacobi",
                                           "gauss_seidel", "hybrid", "chebyshev",
                                           "direct",       "lbfgs",  "newton"};

std::string case_name(const testing::TestParamInfo<Case>& info) {
  return std::get<0>(info.param) + "_" + std::to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Solvers, Hands,
                         testing::Combine(testing::ValuesIn(kSolvers),
                                          testing::Values(1, 3, 10, 30)),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Solvers, HandsInHaste,
                         testing::Combine(testing::ValuesIn(kSolvers), testing::Values(1, 3)),
                         case_name);

}  // namespace
}  // namespace pliant::hands_test
