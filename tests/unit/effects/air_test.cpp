#include "pliant/effects/air/air.h"

#include <gtest/gtest.h>

#include "pliant/effects/air/bubble_pressure.h"
#include "support/expect_refusal.h"
#include "support/measures.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

ClothScene sealed_cloth(const ParameterText& air) {
  ClothScene s;
  s.obstacles = {obstacle(Plane())};
  s.pose = at(0, 0, 0.001);
  s.time_step = 1e-3;
  s.effects = {{"gravity", {}}, {"damping", {}}, {"air", air}, {"contact", {}}};
  return s;
}

AirEffect& air(World& world) { return effect_of<AirEffect>(world, "air"); }

TEST(Air, FlatWithoutAirIsAtRest) {
  auto world = make_world(sealed_cloth({}));
  run_for(*world, 0.1);
  EXPECT_TRUE(air(*world).sealed());
  EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 0.0, 1e-15);
  EXPECT_NEAR(air(*world).pressure(), 101325.0, 1e-6 * 101325.0);
  EXPECT_NEAR(particles_of(*world).x.row(2).maxCoeff(), 0.001, 1e-12);
}

TEST(Air, HeightsThatAreNoneMissNoVolumeWhenAllSettle) {
  ClothScene s = sealed_cloth({});
  s.effects.insert(s.effects.end() - 2, {"self_contact", {{"thickness", "0.004"}}});
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  Positions x = particles_of(*world).x;
  x.row(2).array() += 0.5 * kTinyBubbleHeight;
  const Positions before = x;
  EXPECT_EQ(air(*world).alternating_projection(Eigen::VectorXd::Ones(x.cols()), x), 0.0);
  EXPECT_EQ(x, before);
}

TEST(Air, ALiftedClothWithoutAirIsPressedDownWhenAllSettle) {
  ClothScene s = sealed_cloth({});
  s.effects.insert(s.effects.end() - 2, {"self_contact", {{"thickness", "0.004"}}});
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  Positions x = particles_of(*world).x;
  const double height = 6e-5;
  x.row(2).array() += height;
  // The mean height of what is lifted, over the 0.03 mm that may be left.
  EXPECT_NEAR(air(*world).alternating_projection(Eigen::VectorXd::Ones(x.cols()), x), height / 3e-5,
              1e-6);
  EXPECT_LT(air(*world).volume(x), 0.5 * height * 0.09);
}

TEST(Air, AnUnsealedClothTakesInWhatIsThereWhenItSeals) {
  ClothScene s = sealed_cloth({{"volume", "0.5"}, {"seal_gap", "0.01"}});
  s.pose = at(0, 0, 0.03);
  auto world = make_world(s);
  ASSERT_TRUE(world->step());
  EXPECT_FALSE(air(*world).sealed());
  // Falls 2 cm in 0.063 s; then its edge is within the gap.
  run_for(*world, 0.1);
  EXPECT_TRUE(air(*world).sealed());
  EXPECT_LE(air(*world).amount(), 0.01 * 0.09 + 1e-9);
  EXPECT_GT(air(*world).amount(), 0.0);
}

TEST(Air, WithoutBreakingTheSealHoldsForEver) {
  ClothScene s = sealed_cloth({{"seal_breaks", "false"}, {"volume", "0.0027"}});
  s.pose = at(0, 0, 0.031);  // the volume that 3 cm of height hold
  auto world = make_world(s);
  run_for(*world, 0.02);
  EXPECT_TRUE(air(*world).sealed());
  EXPECT_EQ(air(*world).amount(), 0.0027);
  // The weight of 0.15 kg/m² makes 1.5 Pa: the bubble carries it.
  EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 0.0027, 1e-5);
}

TEST(Air, LeaksLessThroughAWetWeave) {
  ClothScene s = sealed_cloth({{"seal_breaks", "false"}, {"volume", "0.0027"}});
  s.effects.push_back(
      {"wetness", {{"wetness", "0.5"}, {"permeability", "1e-4"}, {"adhesion", "0"}}});
  s.pose = at(0, 0, 0.031);
  auto world = make_world(s);
  double amount = 0.0027;
  // Of a weave half full of water (1 - w)² (1 - w²) is open.
  const double wet = 1e-4 * 0.25 * 0.75;
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(world->step());
    amount -= s.time_step * wet * 0.09 * (air(*world).pressure() - 101325.0);
    EXPECT_NEAR(air(*world).amount(), amount, 1e-13);
  }
  EXPECT_LT(amount, 0.0027 - 1e-9);
}

TEST(Air, LeaksThroughTheWeaveByDarcysLaw) {
  ClothScene s =
      sealed_cloth({{"seal_breaks", "false"}, {"volume", "0.0027"}, {"permeability", "1e-4"}});
  s.pose = at(0, 0, 0.031);
  auto world = make_world(s);
  double amount = 0.0027;
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(world->step());
    amount -= s.time_step * 1e-4 * 0.09 * (air(*world).pressure() - 101325.0);
    EXPECT_NEAR(air(*world).amount(), amount, 1e-12);
  }
  EXPECT_LT(amount, 0.0027);
}

// What has too little room makes itself some, which no energy pays for.
TEST(Air, AtOnceTellsItsEnergyWhereItHasItsRoom) {
  for (const auto& [volume, has_room] : {std::pair("0.0027", true), std::pair("0.0028", false)}) {
    ClothScene s = sealed_cloth({{"volume", volume}, {"seal_breaks", "false"}});
    s.pose = at(0, 0, 0.031);  // 2.7 litres are below it
    auto world = make_world(s);
    air(*world).begin_step(particles_of(*world), s.time_step);
    EXPECT_EQ(air(*world).tells_energy(), has_room) << volume;
  }
}

// The guard of energy once took what leaked for air that was squeezed, and held such steps back.
TEST(Air, ThatLeaksThroughAWideWeaveIsNotSqueezed) {
  for (const char* solver : {"xpbd", "jacobi", "chebyshev", "lbfgs", "direct"}) {
    ClothScene s =
        sealed_cloth({{"seal_breaks", "false"}, {"volume", "0.0024"}, {"permeability", "0.1"}});
    s.obstacles.push_back(obstacle(Box(Eigen::Vector3d(0.05, 0.05, 0.03))));
    s.pose = at(0, 0, 0.031);
    s.solver = solver;
    auto world = make_world(s);
    for (int k = 0; k < 100; ++k) {
      ASSERT_TRUE(world->step());
      EXPECT_FALSE(warns(*world, "energy_held_back")) << solver << ", step " << k;
    }
  }
}

TEST(Air, IsThereAtOnceWithoutAFillTime) {
  auto world = make_world(sealed_cloth({{"volume", "1e-4"}}));
  EXPECT_EQ(air(*world).amount(), 1e-4);
  ASSERT_TRUE(world->step());
  EXPECT_EQ(air(*world).amount(), 1e-4);
}

// Squeezed into no volume it has no energy that means anything: how fast it threw the cloth up was
// a matter of the time step. By the weight alone 1 mm of air takes 1.5 mJ.
TEST(Air, AtOnceThrowsNoClothUp) {
  for (const char* fill_time : {"0", "1e-5"}) {
    for (const double time_step : {1e-4, 1e-3, 5e-3}) {
      ClothScene s =
          sealed_cloth({{"volume", "1e-4"}, {"fill_time", fill_time}, {"seal_breaks", "false"}});
      s.time_step = time_step;
      auto world = make_world(s);
      double fastest = 0.0;
      for (int k = 0; k < 40; ++k) {
        ASSERT_TRUE(world->step());
        fastest = std::max(fastest, particles_of(*world).kinetic_energy());
      }
      EXPECT_LT(fastest, 2e-5) << fill_time << " s, steps of " << time_step << " s";
      EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 1e-4, 1e-7) << time_step;
    }
  }
}

// Nothing holds the edge down: the cloth floats as a plate of that height.
TEST(Air, ThatGoesOutWhileItIsLetInIsTold) {
  for (const char* fill_time : {"0", "0.05"}) {
    for (const char* volume : {"1e-4", "3e-4"}) {
      auto world = make_world(sealed_cloth({{"volume", volume}, {"fill_time", fill_time}}));
      bool told = false;
      double most = 0.0;
      for (int k = 0; k < 100; ++k) {
        ASSERT_TRUE(world->step());
        told = told || warns(*world, "air_escapes");
        most = std::max(most, air(*world).volume(particles_of(*world).x));
      }
      // 9 dm² at the 2 mm of `seal_gap` are 180 cm³.
      const bool is_too_much = std::string(volume) == "3e-4";
      EXPECT_EQ(told, is_too_much) << volume << " m³ in " << fill_time << " s";
      const double at_last = air(*world).volume(particles_of(*world).x);
      if (is_too_much) {
        EXPECT_LT(at_last, 2e-4) << fill_time;
      } else {
        EXPECT_NEAR(at_last, 1e-4, 1e-6) << fill_time;
      }
    }
  }
}

// The weave of dry cloth lets air pass, and wetness has it so unless it is told otherwise.
TEST(Air, ThatGoesThroughDryClothIsTold) {
  struct Case {
    const char *radius, *permeability;
    bool leaks;
  };
  for (const Case& c :
       {Case{"0.08", "2.5e-3", true}, Case{"1", "2.5e-3", false}, Case{"0.08", "0", false}}) {
    ClothScene s =
        sealed_cloth({{"volume", "1e-4"}, {"fill_time", "0.02"}, {"seal_breaks", "false"}});
    s.effects.insert(s.effects.begin() + 2, {"wetness",
                                             {{"wetness", "1"},
                                              {"center", "[0, 0, 0]"},
                                              {"radius", c.radius},
                                              {"permeability", c.permeability},
                                              {"adhesion", "0"}}});
    auto world = make_world(s);
    bool told = false;
    for (int k = 0; k < 200; ++k) {
      ASSERT_TRUE(world->step());
      told = told || warns(*world, "air_leaks");
    }
    EXPECT_EQ(told, c.leaks) << c.radius << " " << c.permeability;
    EXPECT_EQ(air(*world).amount() < 0.9e-4, c.leaks) << air(*world).amount();
    world->reset();
    ASSERT_TRUE(world->step());
    EXPECT_FALSE(warns(*world, "air_leaks")) << "anew";
  }
}

// Only what comes at once is put: air that the cloth held and that something squeezed drives it.
TEST(Air, ThatIsHeldStillDrivesTheCloth) {
  ClothScene s = sealed_cloth({{"seal_breaks", "false"}, {"volume", "0.0027"}});
  s.pose = at(0, 0, 0.031);
  s.time_step = 1e-5;  // below a hundredth of a swing
  auto world = make_world(s);
  particles_of(*world).v.row(2).setConstant(-1.0);
  const double before = particles_of(*world).kinetic_energy();
  double fastest = 0.0;
  for (int k = 0; k < 100; ++k) {
    ASSERT_TRUE(world->step());
    const Particles& particles = particles_of(*world);
    if (particles.momentum().z() > 0.0) fastest = std::max(fastest, particles.kinetic_energy());
  }
  EXPECT_GT(fastest, 0.1 * before);
}

TEST(Air, IsLetInEvenlyOverTheFillTime) {
  auto world = make_world(
      sealed_cloth({{"volume", "1e-4"}, {"fill_time", "0.02"}, {"seal_breaks", "false"}}));
  EXPECT_EQ(air(*world).amount(), 0.0);
  for (int k = 1; k <= 25; ++k) {
    ASSERT_TRUE(world->step());
    EXPECT_NEAR(air(*world).amount(), 1e-4 * std::min(1.0, k / 20.0), 1e-18) << k;
  }
}

// What a step did to the air is undone with the step.
TEST(Air, AnUndoneStepLetsNoneIn) {
  auto world = make_world(
      sealed_cloth({{"volume", "1e-4"}, {"fill_time", "0.02"}, {"permeability", "1e-5"}}));
  run_for(*world, 0.005);
  const double amount = air(*world).amount();
  AppliedForce force;
  force.force.z() = 1e30;
  force.duration = -1.0;
  world->applied_forces().add(force);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(world->step());
  EXPECT_EQ(air(*world).amount(), amount);
}

TEST(Air, ResetRestoresAmountAndSeal) {
  for (const char* fill_time : {"0", "0.02"}) {
    ClothScene s = sealed_cloth({{"volume", "1e-4"}, {"fill_time", fill_time}});
    auto world = make_world(s);
    const double first = air(*world).amount();
    run_for(*world, 0.05);
    world->reset();
    EXPECT_EQ(air(*world).amount(), first) << fill_time;
    EXPECT_TRUE(air(*world).sealed());
    EXPECT_EQ(air(*world).pressure(), 101325.0);
  }
}

// A cloth at its contact distance from the plane holds no volume, before the first step too.
TEST(Air, VolumeIsRightBeforeTheFirstStep) {
  auto flat = make_world(sealed_cloth({}));
  EXPECT_EQ(air(*flat).volume(particles_of(*flat).x), 0.0);
  ClothScene s = sealed_cloth({{"volume", "0.0027"}});
  s.pose = at(0, 0, 0.031);
  auto domed = make_world(s);
  EXPECT_NEAR(air(*domed).volume(particles_of(*domed).x), 0.0027, 1e-15);
  // At atmospheric pressure the air has done no work yet.
  EXPECT_NEAR(air(*domed).potential_energy(body_of(*domed)), 0.0, 1e-9);
}

TEST(Air, RefusesASceneWithoutAnythingToLieOn) {
  ClothScene s = sealed_cloth({});
  s.obstacles = {};
  expect_refusal([&] { make_world(s); }, {"effect 'air' needs an obstacle"});
  s.obstacles = {obstacle(Box({1, 1, 1}))};
  s.obstacles[0].liquid = true;
  expect_refusal([&] { make_world(s); }, {"effect 'air' needs an obstacle"});
}

TEST(Air, IsSealedOnTheObstaclesThatItNames) {
  ClothScene s = sealed_cloth({{"obstacles", "box, sphere"}});
  s.obstacles = {obstacle(Plane()), obstacle(Box({1, 1, 0.1}), at(0, 0, -0.15)),
                 obstacle(Sphere(0.01), at(3, 3, 0))};
  // From the box's top, 10 cm below the plane, less half of the cloth's thickness.
  const auto world = make_world(s);
  EXPECT_NEAR(air(*world).volume(particles_of(*world).x), 0.09 * 0.1, 1e-12);
  s.effects[2].second = {{"obstacles", "boks"}};
  expect_refusal([&] { make_world(s); }, {"effect 'air': obstacles:", "boks", "box"});
}

TEST(Air, RefusesBadParameters) {
  const auto refuse = [](const ParameterText& text, const std::vector<std::string>& parts) {
    expect_refusal([&] { make_world(sealed_cloth(text)); }, parts);
  };
  refuse({{"volume", "-1e-9"}}, {"'volume'", ">= 0", "m^3"});
  refuse({{"atmosphere", "0"}}, {"'atmosphere'", "> 0", "Pa"});
  refuse({{"permeability", "-1"}}, {"'permeability'", "m/(s Pa)"});
  refuse({{"seal_gap", "0"}}, {"'seal_gap'", "[m]"});
  refuse({{"gas", "isobaric"}}, {"unknown gas 'isobaric'", "isothermal", "adiabatic"});
  refuse({{"edge_leak", "-1"}}, {"'edge_leak'", "m^2/(s Pa)"});
  refuse({{"seal_breaks", "maybe"}}, {"'seal_breaks'", "true or false"});
}

/// Under a triangle of 1/2 m² that is 1 cm above a plane and that each pascal moves by 10 µm.
Bubble bubble_under_a_triangle(double amount, double gauge) {
  Bubble bubble;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0.0, 1.0, 0.0,  //
      0.0, 0.0, 1.0,               //
      0.01, 0.01, 0.01;
  mesh.triangles.resize(3, 1);
  mesh.triangles << 0, 1, 2;
  bubble.vertices = {0, 1, 2};
  bubble.triangles = {mesh.triangles, Eigen::Vector3d::Constant(1.0 / 3.0)};
  bubble.areas.setConstant(3, 0.5 / 3.0);
  bubble.amount = amount;
  bubble.gauge = gauge;
  bubble.x = mesh.vertices;
  bubble.mobility.setConstant(3, 1e-5 / (0.5 / 3.0));
  const std::vector<Obstacle> plane = {obstacle(Plane())};
  FootFinder(plane, {0}).find(bubble.x, 0.0, bubble.foot_points);
  take_gradient(bubble);
  return bubble;
}

// A thousand pascals less close it. Without air in it that is what it takes, or more where it would
// still press then.
TEST(BubblePressure, OfABubbleWithoutAirPullsButNeverPresses) {
  for (const double gauge : {-200.0, 0.0, 500.0, 1000.0, 3000.0}) {
    Bubble bubble = bubble_under_a_triangle(0.0, gauge);
    const double after = gauge + pressure_change(AirGas(), 0.0, bubble);
    EXPECT_NEAR(after, std::min(gauge - 1000.0, 0.0), 1e-3) << gauge;
  }
  Bubble filled = bubble_under_a_triangle(0.005, 0.0);
  EXPECT_NEAR(pressure_change(AirGas(), 0.0, filled), 0.0, 1e-3);
}

}  // namespace
}  // namespace pliant
