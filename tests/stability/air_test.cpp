#include "pliant/effects/air/air.h"

#include "pliant/study/experiments/cloth_scene.h"
#include "support/solvers/solver_systems.h"
#include "support/solvers/stable_step.h"

namespace pliant {
namespace {

constexpr double kAtmosphere = 101325.0;  // [Pa]
constexpr double kLift = 0.05;            // [m]
// With no air below, the atmosphere slams the lifted cloth down: p h = sigma v² / 2, 260 m/s.
const double kFastest = std::sqrt(2.0 * kAtmosphere * kLift / 0.15);

class SealedAir : public EverySolver {
 protected:
  ClothScene lying_scene(double volume, bool seal_breaks = true) const {
    ClothScene scene;
    scene.material = soft_material();
    scene.obstacles = {obstacle(Plane())};
    scene.pose = at(0, 0, 0.001);  // half the thickness: where contact holds it
    scene.effects = {
        {"gravity", {}},
        {"damping", {{"rate", "2"}}},
        {"air",
         {{"volume", std::to_string(volume)}, {"seal_breaks", seal_breaks ? "true" : "false"}}},
        {"contact", {{"thickness", "0.002"}}},
        {"friction", {}}};
    scene.solver = solver();
    return scene;
  }

  std::unique_ptr<World> lying(double volume, bool seal_breaks = true) const {
    return make_stable_world(lying_scene(volume, seal_breaks));
  }

  /// Moves fixed particles by `displacement` at `speed`, as a hand does that holds them.
  static void carry(World& world, const std::vector<int>& held, double displacement, double speed) {
    const double seconds = std::abs(displacement) / speed;
    const int steps = std::max(1, static_cast<int>(std::lround(seconds / world.time_step())));
    for (int k = 0; k < steps; ++k) {
      for (int i : held) particles_of(world).x(2, i) += displacement / steps;
      ASSERT_TRUE(world.step()) << body_of(world).report.failure;
      expect_sane(world);
    }
  }

  static void hold(World& world, double seconds) {
    const double end = world.time() + seconds;
    while (world.time() < end) {
      ASSERT_TRUE(world.step()) << body_of(world).report.failure;
      expect_sane(world);
    }
  }

  // Air has no tension, so the pressure is never negative. All the energy that a cloth at 5 m/s has
  // (0.17 J) compresses 0.4 l of air, p V = 40 J, by 9 %: no more than 1.1 atmospheres where air
  // has converged.
  static void expect_sane(World& world) {
    const auto& air = effect_of<AirEffect>(world, "air");
    const double p = air.pressure();
    EXPECT_TRUE(std::isfinite(p)) << world.time();
    EXPECT_GE(p, 0.0) << world.time();
    EXPECT_TRUE(p <= 1.1 * kAtmosphere || warns(world, "air_limited")) << p;
    EXPECT_TRUE(world.reactions().front().force.allFinite()) << world.time();
    EXPECT_LT(largest_speed(world), kFastest) << world.time();
  }

  static void fix(World& world, const std::vector<int>& held) {
    for (int i : held) particles_of(world).fix(i);
    world.system_changed();
  }
};

TEST_P(SealedAir, FlatClothStaysFlat) {
  for (bool seal_breaks : {true, false}) {
    const auto world = lying(0.0, seal_breaks);
    const Positions start = particles_of(*world).x;
    hold(*world, 0.5);
    EXPECT_LT((particles_of(*world).x - start).cwiseAbs().maxCoeff(), 1e-6);
  }
}

// The volume of the sealed air is that at atmospheric pressure; the cloth's weight compresses it by
// 1.5 Pa of 1e5 only.
TEST_P(SealedAir, InflatesToItsVolume) {
  const auto world = lying(4e-4, false);
  hold(*world, 2.0);
  const auto& air = effect_of<AirEffect>(*world, "air");
  const double volume = air.volume(particles_of(*world).x);
  EXPECT_NEAR(air.pressure() * volume / (kAtmosphere * 4e-4), 1.0, 0.01);
  EXPECT_FALSE(warns(*world, "air_limited"));
  EXPECT_NEAR(volume, 4e-4, 4e-6);
}

TEST_P(SealedAir, LiftedFastAndSlowlyAndPutBack) {
  for (double volume : {0.0, 4e-4}) {
    for (double speed : {0.1, 5.0}) {
      for (bool seal_breaks : {true, false}) {
        SCOPED_TRACE(testing::Message() << volume << " m³, " << speed << " m/s, " << seal_breaks);
        const auto world = lying(volume, seal_breaks);
        const std::vector<int> held = {23, 24, 25};
        fix(*world, held);
        carry(*world, held, kLift, speed);
        hold(*world, 0.2);
        carry(*world, held, -kLift, speed);
        hold(*world, 0.2);
        EXPECT_GT(particles_of(*world).x.row(2).minCoeff(), 0.0);
      }
    }
  }
}

// Lifted by a corner the seal breaks: air below it is the room's. Put down, it is sealed anew with
// what is then below.
TEST_P(SealedAir, BrokenAndSealedAgain) {
  for (double volume : {0.0, 4e-4}) {
    for (double speed : {0.1, 5.0}) {
      SCOPED_TRACE(testing::Message() << volume << " m³, " << speed << " m/s");
      const auto world = lying(volume);
      const auto& air = effect_of<AirEffect>(*world, "air");
      fix(*world, {0, 1});
      for (int k = 0; k < 2; ++k) {
        carry(*world, {0, 1}, kLift, speed);
        hold(*world, 0.01);
        EXPECT_FALSE(air.sealed());
        carry(*world, {0, 1}, -kLift, speed);
        hold(*world, 1.0);
        // Air that other bubbles still hold may keep an edge up where it crumpled.
        EXPECT_TRUE(air.sealed() || volume > 0.0);
        // No more than fits under a cloth that is nowhere higher than the hand.
        EXPECT_LE(air.amount(), 0.3 * 0.3 * kLift);
      }
    }
  }
}

// A bar presses the middle of the inflated cloth down to the plane, to two bubbles. Raised, it lets
// them merge.
TEST_P(SealedAir, SplitAndMerged) {
  ClothScene scene = lying_scene(4e-4, false);
  scene.obstacles.push_back(obstacle(Box({0.02, 0.4, 0.02}), at(0, 0, 0.05)));
  const auto world = make_stable_world(scene);
  hold(*world, 1.0);
  const auto& air = effect_of<AirEffect>(*world, "air");
  const auto move_bar = [&](double displacement) {
    const double end = world->time() + 0.2, speed = displacement / 0.2;
    while (world->time() < end) {
      world->obstacles()[1].pose_end.translation().z() += speed * world->time_step();
      ASSERT_TRUE(world->step()) << body_of(*world).report.failure;
      expect_sane(*world);
    }
  };
  for (int k = 0; k < 3; ++k) {
    move_bar(-0.037);  // to 3 mm above the plane, where the cloth's thickness fits
    hold(*world, 0.2);
    // Pressed to the plane along its middle, on either side the cloth stands above it.
    EXPECT_LT(particles_of(*world).x(2, 24), 0.0021);
    EXPECT_GT(particles_of(*world).x(2, 22), 0.004);
    EXPECT_GT(particles_of(*world).x(2, 26), 0.004);
    move_bar(0.037);
    hold(*world, 0.3);
  }
  hold(*world, 1.0);
  const double volume = air.volume(particles_of(*world).x);
  EXPECT_NEAR(air.amount(), 4e-4, 1e-6 * 4e-4);
  EXPECT_NEAR(air.pressure() * volume / (kAtmosphere * 4e-4), 1.0, 0.01);
}

PLIANT_FOR_EVERY_SOLVER(SealedAir);

/// Wet satin, which two hands lift without air below.
ClothLift::Options two_hands() {
  ClothLift::Options options;
  options.side = 31;
  options.points = 2;
  options.time_step = 1.0 / 300.0;
  options.solver_parameters = {{"iterations", "60"}};
  options.material = {{"areal_density", "0.2"},
                      {"stretch_warp", "1000"},
                      {"stretch_weft", "1000"},
                      {"shear", "50"},
                      {"bending", "1e-5"}};
  options.max_stretch = 1.01;
  return options;
}

// With a limit, and layers that stay apart, cloth rises in fins alone: what is beside them lies.
// Limits that know of no air lifted all of it, and it sprang up.
TEST(AirAndLimit, WithoutAirClothRisesInFinsAlone) {
  ClothLift lift(two_hands());
  const double lying = 0.5 * ClothLift::kThickness, rise = 0.05 / 300.0;
  const double cell = ClothLift::kWidth / (two_hands().side - 1);
  for (double height = rise; height < 0.01; height += rise) {
    ASSERT_TRUE(lift.step(rise)) << lift.world().failure();
    const Positions& x = lift.body().particles().x;
    EXPECT_LE(metric(lift.body().report, "largest_strain"), 0.02);
    EXPECT_GE(lift.air().pressure(), 0.0);
    EXPECT_LE(std::abs(lift.air().volume(x)), 8e-6) << height;
    EXPECT_LE(x.row(2).maxCoeff(), lying + height + cell) << height;
    for (int i = 0; i < x.cols(); ++i) {
      if (std::abs(lift.rest()(1, i)) < 0.06) continue;
      EXPECT_LE(x(2, i), lying + 0.001) << height;
    }
  }
}

}  // namespace
}  // namespace pliant
