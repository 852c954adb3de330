// Contact between bodies of different models, each with a solver of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel/parallel.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/worlds.h"

namespace pliant::body_contact_test {
namespace {

constexpr double kGravity = 9.81;
// Of a collision's momentum that may be lost.
constexpr double kMomentum = 1e-10;

const char* const kEffects =
    "  gravity: {}\n  contact: {}\n  friction: {}\n  damping: {rate: 5}\n  body_contact: {}\n";
const char* const kPlane = "obstacles: [{name: table, shape: plane}]\n";

struct Pair {
  std::string lower, upper;
};

std::string name_of(const testing::TestParamInfo<Pair>& info) {
  return info.param.lower + "_under_" + info.param.upper;
}

class BodyPair : public testing::TestWithParam<Pair> {
 protected:
  double thickness(const std::string& model) const { return model == "cloth" ? 0.0 : 0.05; }
  /// The upper body `gap` above the lower one, which is that far above z = 0.
  std::vector<std::string> stacked(double gap, const std::string& of_upper = "") const {
    const double lower = thickness(GetParam().lower), upper = thickness(GetParam().upper);
    return {slab("lower", GetParam().lower, gap + 0.5 * lower),
            slab("upper", GetParam().upper, 2.0 * gap + lower + 0.5 * upper, of_upper)};
  }
};

TEST_P(BodyPair, AStackCarriesItsWeight) {
  const auto world = world_of(scene_text(stacked(0.0025), kEffects, kPlane));
  run_for(*world, 0.8);
  Eigen::Vector3d on_upper = Eigen::Vector3d::Zero(), on_lower = on_upper, on_table = on_upper;
  constexpr int kSteps = 40;
  for (int k = 0; k < kSteps; ++k) {
    ASSERT_TRUE(world->step());
    on_upper += contact_force_on(*world, "upper") / kSteps;
    on_lower += contact_force_on(*world, "lower") / kSteps;
    on_table += world->reactions().front().force / kSteps;
  }
  const double upper = kGravity * mass_of(*world, "upper");
  const double both = upper + kGravity * mass_of(*world, "lower");
  EXPECT_NEAR(on_upper.z(), upper, 0.01 * upper);
  EXPECT_LT((on_upper + on_lower).norm(), 1e-9 * upper);
  EXPECT_NEAR(on_table.z(), -both, 0.01 * both);
}

TEST(BodyContact, StiffAndSoftSolidsCarryWhatLiesOnThem) {
  for (const char* young : {"1.0e+4", "1.0e+6", "1.0e+8"}) {
    for (const char* upper : {"rigid", "cloth", "patch"}) {
      const std::string lower = fmt::format(
          "  - {{name: lower, model: patch, geometry: {{block: {{size: [0.1, 0.1, 0.05], cells: "
          "[4, 4, 2]}}}}, material: {{young: {}, density: 500}}, position: [0, 0, 0.0275], "
          "rotation_rpy: [0, 0, 0.6]}}\n",
          young);
      const double top = 0.0525 + 0.0025 + 0.5 * (upper == std::string("cloth") ? 0.0 : 0.05);
      const auto world = world_of(scene_text(
          {lower, slab("upper", upper, top, "velocity: [0.05, 0, 0]")}, kEffects, kPlane));
      run_for(*world, 0.8);
      double mean = 0.0;
      for (int k = 0; k < 40; ++k) {
        ASSERT_TRUE(world->step());
        mean += contact_force_on(*world, "upper").z() / 40;
      }
      const double weight = kGravity * mass_of(*world, "upper");
      EXPECT_NEAR(mean, weight, 0.05 * weight) << upper << " on " << young << " Pa";
    }
  }
}

TEST_P(BodyPair, AFastDropDoesNotPass) {
  const auto world = world_of(scene_text(stacked(0.02, "velocity: [0, 0, -5]"), kEffects, kPlane));
  const double before = world->energies().total();
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_LT(world->energies().total(), 1.02 * before) << "step " << k;
  }
  const double lower = body_named(*world, "lower").particles().center_of_mass().z();
  const double upper = body_named(*world, "upper").particles().center_of_mass().z();
  EXPECT_GT(upper, lower);
}

TEST_P(BodyPair, APushPassesMomentumOn) {
  const auto world = world_of(
      scene_text(stacked(0.004, "velocity: [0.1, 0, -1]"), "  body_contact: {friction: 0.3}\n"));
  const Eigen::Vector3d before = momentum_of(*world);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d lower = body_named(*world, "lower").particles().momentum();
    const Eigen::Vector3d upper = body_named(*world, "upper").particles().momentum();
    ASSERT_TRUE(world->step());
    // Each body has what the forces give it that are told.
    for (const auto& [name, own] : {std::pair("lower", lower), std::pair("upper", upper)}) {
      const Eigen::Vector3d gained = body_named(*world, name).particles().momentum() - own;
      const Eigen::Vector3d impulse = world->time_step() * contact_force_on(*world, name);
      ASSERT_LT((gained - impulse).norm(), kMomentum * before.norm()) << name << ", step " << k;
    }
  }
  EXPECT_LT((momentum_of(*world) - before).norm(), kMomentum * before.norm());
  // They go on together, or nearly so.
  const double common = before.z() / (mass_of(*world, "lower") + mass_of(*world, "upper"));
  const Particles& lower = body_named(*world, "lower").particles();
  EXPECT_LT(lower.momentum().z() / lower.mass.sum(), 0.5 * common);
}

INSTANTIATE_TEST_SUITE_P(Models, BodyPair,
                         testing::Values(Pair{"patch", "rigid"}, Pair{"rigid", "patch"},
                                         Pair{"rigid", "rigid"}, Pair{"patch", "patch"},
                                         Pair{"cloth", "patch"}, Pair{"patch", "cloth"},
                                         Pair{"cloth", "rigid"}, Pair{"rigid", "cloth"},
                                         Pair{"cloth", "cloth"}, Pair{"viscoelastic", "cloth"},
                                         Pair{"viscoelastic", "patch"},
                                         Pair{"viscoelastic", "rigid"}),
                         name_of);

TEST(BodyContact, TheSearchForPassesFindsOne) {
  const auto world = world_of(scene_text(
      {slab("one", "rigid", 0.1), slab("other", "patch", 0.13, "rotation_rpy: [0.3, 0.2, 0.1]")},
      "  gravity: {}\n"));
  EXPECT_GT(intersections_between(*world), 0);
}

TEST(BodyContact, AClothThatFallsOverABallNeverPassesIt) {
  const std::string ball =
      "  - {name: ball, model: patch, geometry: {sphere: {radius: 0.04}, tetrahedra: 200, "
      "surface_level: 3}, material: {young: 3.0e+4, density: 500}, position: [0, 0, 0.042]}\n";
  const std::string cloth =
      "  - {name: cloth, model: cloth, geometry: {grid: {size: [0.16, 0.16], vertices: [12, 12]}}, "
      "material: {areal_density: 0.15}, position: [0.003, 0.002, 0.1], velocity: [0, 0, -3]}\n";
  const auto world = world_of(scene_text({ball, cloth}, kEffects, kPlane));
  ASSERT_EQ(intersections_between(*world), 0);
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(world->step());
    ASSERT_EQ(intersections_between(*world), 0) << "step " << k;
  }
  EXPECT_GT(body_named(*world, "cloth").particles().x.row(2).maxCoeff(), 0.06);
}

/// Acceleration along a slope of a slab on another one that is held there [m/s²].
double acceleration_on(const std::string& lower, const std::string& upper, double friction,
                       double slope) {
  const double angle = std::atan(slope);
  const std::string gravity = fmt::format("  gravity: {{acceleration: [{}, 0, {}]}}\n",
                                          kGravity * std::sin(angle), -kGravity * std::cos(angle));
  const std::vector<std::string> bodies = {
      slab("lower", lower, 0.025,
           "attachments: [{name: hold, sphere: {center: [0, 0, 0], radius: 0.2}, to: world, "
           "stiffness: 1.0e+6}]"),
      slab("upper", upper, upper == "cloth" ? 0.052 : 0.077)};
  const auto world = world_of(
      scene_text(bodies, gravity + fmt::format("  body_contact: {{friction: {}}}\n", friction)));
  const Particles& particles = body_named(*world, "upper").particles();
  const auto speed = [&] { return particles.momentum().x() / particles.mass.sum(); };
  // Only as long as no row of the cloth has slid over the edge.
  const int first = upper == "cloth" ? 4 : 8, steps = upper == "cloth" ? 12 : 16;
  for (int k = 0; k < first; ++k) EXPECT_TRUE(world->step());
  const double before = speed();
  for (int k = 0; k < steps; ++k) EXPECT_TRUE(world->step());
  return (speed() - before) / (steps * world->time_step());
}

class BodyFriction : public testing::TestWithParam<Pair> {};

TEST_P(BodyFriction, HoldsBelowItsAngleAndSlipsAbove) {
  const double slope = 0.4, angle = std::atan(slope);
  const auto& [lower, upper] = GetParam();
  EXPECT_LT(std::abs(acceleration_on(lower, upper, 1.05 * slope, slope)), 0.02);
  const double expected = 0.5 * kGravity * std::sin(angle);
  EXPECT_NEAR(acceleration_on(lower, upper, 0.5 * slope, slope), expected, 0.02 * expected);
}

INSTANTIATE_TEST_SUITE_P(Models, BodyFriction,
                         testing::Values(Pair{"rigid", "rigid"}, Pair{"rigid", "patch"},
                                         Pair{"patch", "rigid"}, Pair{"patch", "patch"},
                                         Pair{"rigid", "cloth"}, Pair{"patch", "cloth"}),
                         name_of);

/// Acceleration along a slope of a slab on the ground, beside another body of its group [m/s²].
double acceleration_on_ground(const std::string& model, const std::string& other, double friction,
                              double slope) {
  const double angle = std::atan(slope);
  const std::string gravity = fmt::format("  gravity: {{acceleration: [{}, 0, {}]}}\n",
                                          kGravity * std::sin(angle), -kGravity * std::cos(angle));
  const std::string aside =
      other == "cloth" ? "  - {name: aside, model: cloth, geometry: {grid: {size: [0.1, "
                         "0.1], vertices: [5, 5]}}, position: [0, 0.4, 0.003]}\n"
                       : "  - {name: aside, model: rigid, geometry: {box: {size: [0.1, 0.1, "
                         "0.05]}}, position: [0, 0.4, 0.027]}\n";
  const auto world = world_of(scene_text(
      {slab("slab", model, 0.027), aside},
      gravity + fmt::format("  contact: {{thickness: 0.002}}\n  friction: {{coefficient: {}}}\n"
                            "  body_contact: {{}}\n",
                            friction),
      kPlane));
  const Particles& particles = body_named(*world, "slab").particles();
  const auto speed = [&] { return particles.momentum().x() / particles.mass.sum(); };
  for (int k = 0; k < 32; ++k) EXPECT_TRUE(world->step());
  const double before = speed();
  constexpr int kSteps = 16;
  for (int k = 0; k < kSteps; ++k) EXPECT_TRUE(world->step());
  return (speed() - before) / (kSteps * world->time_step());
}

class GroundFriction : public testing::TestWithParam<Pair> {};

TEST_P(GroundFriction, ActsOnBodiesThatAreMovedTogether) {
  const double slope = 0.4, angle = std::atan(slope);
  const auto& [model, other] = GetParam();
  EXPECT_LT(std::abs(acceleration_on_ground(model, other, 1.05 * slope, slope)), 0.02);
  const double expected = 0.5 * kGravity * std::sin(angle);
  EXPECT_NEAR(acceleration_on_ground(model, other, 0.5 * slope, slope), expected, 0.02 * expected);
}

INSTANTIATE_TEST_SUITE_P(Models, GroundFriction,
                         testing::Values(Pair{"rigid", "rigid"}, Pair{"rigid", "cloth"},
                                         Pair{"patch", "rigid"}, Pair{"patch", "cloth"}),
                         name_of);

TEST(BodyContact, SolversThatTakeTurnsTellTheirError) {
  const auto run = [&](const std::string& cloth, const std::string& ball) {
    return world_of(scene_text(
        {"  - {name: ball, model: patch, geometry: {sphere: {radius: 0.05}, tetrahedra: 150, "
         "surface_level: 3}, position: [-0.06, 0, 0.053], material: {young: 5.0e+4, density: 500}, "
         "solver: " +
             ball + "}\n",
         "  - {name: box, model: rigid, geometry: {box: {size: [0.07, 0.09, 0.06]}}, position: "
         "[0.075, 0, 0.033], material: {density: 400}, solver: " +
             cloth + "}\n",
         "  - {name: strip, model: cloth, geometry: {grid: {size: [0.32, 0.12], vertices: [17, "
         "7]}}, position: [0, 0, 0.13], velocity: [0, 0, -0.5], material: {areal_density: 0.2}, "
         "solver: " +
             cloth + "}\n"},
        kEffects, kPlane));
  };
  const auto exact = run("{name: xpbd, iterations: 2000}", "{name: lbfgs, iterations: 40}");
  struct Given {
    std::unique_ptr<World> world;
    double most = 0.0;
    std::vector<double> told;  // in each step
  };
  std::vector<Given> all;
  for (const char* iterations : {"20", "40", "60"}) {
    all.push_back({run(std::string("{name: xpbd, iterations: ") + iterations + "}",
                       "{name: lbfgs, iterations: 10}")});
  }
  const auto error_of = [&](World& world, const std::string& name) {
    const Positions& x = body_named(world, name).particles().x;
    const Positions& exactly = body_named(*exact, name).particles().x;
    return (x - exactly).norm() / (exactly - body_named(world, name).initial.x).norm();
  };
  for (int k = 0; k < 60; ++k) {
    ASSERT_TRUE(exact->step());
    for (Given& given : all) {
      ASSERT_TRUE(given.world->step());
      if (k < 12) continue;  // the box and the ball rest yet
      given.told.push_back(given.world->bodies().front().report.error.value());
      for (const char* name : {"ball", "strip"}) {
        given.most = std::max(given.most, error_of(*given.world, name));
      }
    }
  }
  for (Given& given : all) {
    // A single estimate may be off by more, and which step has one is chance.
    const auto middle = given.told.begin() + static_cast<std::ptrdiff_t>(given.told.size() / 2);
    std::nth_element(given.told.begin(), middle, given.told.end());
    EXPECT_GT(given.most, 0.02);
    EXPECT_LT(given.most, 2.0 * *middle);
    EXPECT_GT(given.most, *middle / 2.0);
  }
}

TEST(BodyContact, LockstepEndsWhereOneSolverDoes) {
  const auto run = [&](const std::string& cloth, const std::string& patch) {
    const std::string lower = slab("lower", "patch", 0.025, "solver: " + patch);
    const std::string upper =
        "  - {name: upper, model: cloth, geometry: {grid: {size: [0.08, 0.08], vertices: [5, 5]}}, "
        "material: {areal_density: 0.3, stretch_warp: 5, stretch_weft: 5, shear: 1, bending: 0}, "
        "position: [0, 0, 0.0525], solver: " +
        cloth + "}\n";
    const auto world = world_of(scene_text(
        {lower, upper}, "  gravity: {}\n  contact: {}\n  body_contact: {friction: 0}\n", kPlane));
    for (int k = 0; k < 12; ++k) EXPECT_TRUE(world->step());
    Positions all(3, 0);
    for (const Body& body : world->bodies()) {
      const Positions& own = body.particles().x;
      all.conservativeResize(3, all.cols() + own.cols());
      all.rightCols(own.cols()) = own;
    }
    return all;
  };
  const std::string lbfgs = "{name: lbfgs, iterations: 400, tolerance: 1.0e-9}";
  const Positions one = run(lbfgs, lbfgs);
  const Positions two = run("{name: xpbd, iterations: 8000}", lbfgs);
  const Positions few = run("{name: xpbd, iterations: 20}", "{name: lbfgs, iterations: 10}");
  EXPECT_LT((two - one).cwiseAbs().maxCoeff(), 2e-6);
  EXPECT_LT((few - one).cwiseAbs().maxCoeff(), 1e-3);
}

// Solvers that take turns, and one that begins with the forces of the last step.
class BodyContactRepeats : public testing::TestWithParam<std::string> {};

TEST_P(BodyContactRepeats, ForAnyNumberOfThreadsAndAfterALoad) {
  const double z = GetParam() == "cloth" ? 0.07 : 0.085;
  const std::string text =
      scene_text({slab("lower", "patch", 0.03), slab("upper", GetParam(), z)}, kEffects, kPlane);
  const auto end = [&](int threads) {
    set_threads(threads);
    const auto world = world_of(text);
    for (int k = 0; k < 40; ++k) EXPECT_TRUE(world->step());
    set_threads(1);
    return body_named(*world, "upper").particles().x;
  };
  const Positions one = end(1);
  EXPECT_EQ(one, end(2));
  EXPECT_EQ(one, end(4));
  const auto world = world_of(text);
  for (int k = 0; k < 25; ++k) ASSERT_TRUE(world->step());
  const Checkpoint saved = world->save();
  for (int k = 0; k < 15; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(body_named(*world, "upper").particles().x, one);
  world->load(saved);
  for (int k = 0; k < 15; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(body_named(*world, "upper").particles().x, one);
  world->reset();
  for (int k = 0; k < 40; ++k) ASSERT_TRUE(world->step());
  EXPECT_EQ(body_named(*world, "upper").particles().x, one);
}

INSTANTIATE_TEST_SUITE_P(Uppers, BodyContactRepeats, testing::Values("cloth", "patch"),
                         [](const auto& info) { return info.param; });

// At rest the forces of the last step are those of this one: hardly anything is left to find.
TEST(BodyContact, ForcesThatAreKnownAreFoundAgain) {
  for (const auto& [solver, metric] :
       {std::pair("", "linear_iterations"),
        std::pair("solver: {name: lbfgs, error: 0.03, most_iterations: 40}\n",
                  "inner_iterations")}) {
    const auto world =
        world_of(scene_text({slab("lower", "patch", 0.026), slab("upper", "patch", 0.078)},
                            kEffects, std::string(kPlane) + solver));
    const auto iterations = [&, name = metric] {
      double sum = 0.0;
      for (const Metric& each : world->bodies().front().report.metrics) {
        if (each.name == name) sum += each.value;
      }
      return sum;
    };
    double first = 0.0;
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(world->step());
      first = std::max(first, iterations());
    }
    EXPECT_LT(iterations(), 0.5 * first) << solver;
  }
}

TEST(BodyContact, KeepsLiquidAndCloth) {
  const std::string drop =
      "  - {name: drop, model: viscoelastic, geometry: {block: {size: [0.03, 0.03, 0.03]}, "
      "particles: 120}, material: {state: elastic, density: 800}, position: [0, 0, 0.13]}\n";
  const std::string sheet =
      "  - {name: sheet, model: cloth, geometry: {grid: {size: [0.2, 0.2], vertices: [15, 15]}}, "
      "material: {areal_density: 0.3}, position: [0, 0, 0.1], fixed: [{corner: upper_left}, "
      "{corner: upper_right}, {corner: lower_left}, {corner: lower_right}]}\n";
  const auto world = world_of(scene_text({sheet, drop}, "  gravity: {}\n  body_contact: {}\n"));
  for (int k = 0; k < 120; ++k) ASSERT_TRUE(world->step()) << world->failure();
  const Positions& drops = body_named(*world, "drop").particles().x;
  const double lowest = body_named(*world, "sheet").particles().x.row(2).minCoeff();
  EXPECT_GT(drops.row(2).minCoeff(), lowest - 0.005);
}

}  // namespace
}  // namespace pliant::body_contact_test
