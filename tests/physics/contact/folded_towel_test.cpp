// A towel on a table, one edge of which is carried over in an arc and laid on the other, at default
// settings.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "pliant/core/obstacle.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::folded_towel_test {
namespace {

constexpr double kHalf = 0.15;                 // of the towel's edge [m]
constexpr double kBegins = 0.3, kEnds = 1.5;   // of the arc [s]
constexpr double kAbove = 0.02;                // the clip, over the edge that it holds [m]
constexpr double kLow = 0.003, kLaid = 0.006;  // height of the edge at first, and at last [m]

/// Carries the clip, an obstacle that touches nothing.
class ArcDriver final : public ObstacleDriver {
 public:
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    const double share = std::clamp((time - kBegins) / (kEnds - kBegins), 0.0, 1.0);
    const double angle = M_PI * share, low = kLow + share * (kLaid - kLow);
    obstacles[1].pose_end = Eigen::Isometry3d(
        Eigen::Translation3d(kHalf * std::cos(angle), 0.0, low + kAbove + kHalf * std::sin(angle)));
  }
};

std::unique_ptr<World> folded_towel() {
  auto world = world_of(
      "time_step: 0.01\nbodies:\n  - name: towel\n    model: cloth\n    geometry: {grid: {size: "
      "[0.3, 0.3], vertices: [15, 15]}}\n    position: [0, 0, 0.001]\n    material: "
      "{areal_density: 0.3, stretch_warp: 500, stretch_weft: 500, shear: 50, bending: 2.0e-5}\n    "
      "attachments: [{name: edge, box: {min: [0.149, -0.2, -1], max: [0.2, 0.2, 1]}, to: clip, "
      "stiffness: 1000}]\n"
      "obstacles: [{name: table, shape: plane}, {name: clip, shape: sphere, radius: 0.003, "
      "position: [0.15, 0, 0.023]}]\n"
      "effects:\n  gravity: {}\n  contact: {thickness: 0.002}\n  friction: {coefficient: 0.5}\n"
      "  self_contact: {thickness: 0.002}\n");
  world->add_driver(std::make_unique<ArcDriver>());
  return world;
}

TEST(FoldedTowel, ConvergesInFewIterations) {
  const auto world = folded_towel();
  const Body& towel = world->bodies().front();
  int iterations = 0, at_rest = 0, unconverged = 0;
  constexpr int kSteps = 220, kRest = 40;
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world->step());
    unconverged += towel.report.ended_by == EndedBy::kIterations ? 1 : 0;
    (k < kSteps - kRest ? iterations : at_rest) += towel.report.iterations;
  }
  // Contacts that are stiff beside a sheet's answer along their normals open and close each other:
  // with them, 70 steps did not converge in 50 iterations.
  EXPECT_LE(unconverged, 3);
  EXPECT_LT(iterations, 8 * (kSteps - kRest));
  // The layers begin each step with the forces of the last one.
  EXPECT_LT(at_rest, 4 * kRest);
}

TEST(FoldedTowel, LiesInTwoLayers) {
  const auto world = folded_towel();
  run_for(*world, 2.2);
  const Particles& towel = world->bodies().front().particles();
  EXPECT_LT(towel.kinetic_energy(), 1e-8);
  double left = kHalf, right = -kHalf;
  for (int i = 0; i < towel.size(); ++i) {
    EXPECT_GT(towel.x(2, i), 0.9e-3) << i;
    left = std::min(left, towel.x(0, i));
    right = std::max(right, towel.x(0, i));
  }
  EXPECT_NEAR(right - left, kHalf, 0.002);
  const double weight = 9.81 * towel.mass.sum();
  const auto reactions = world->reactions();
  EXPECT_NEAR(reactions[0].force.z() + reactions[1].force.z(), -weight, 1e-3 * weight);
}

}  // namespace
}  // namespace pliant::folded_towel_test
