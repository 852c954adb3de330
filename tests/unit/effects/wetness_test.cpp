#include "pliant/effects/wetness/wetness.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/expect_refusal.h"
#include "support/worlds/worlds.h"

namespace pliant {
namespace {

constexpr double kArea = 0.3 * 0.3, kDry = 0.15 * kArea;  // [m²], [kg]

ClothScene wet_cloth(const ParameterText& wetness) {
  ClothScene s;
  s.obstacles = {obstacle(Plane())};
  s.pose = at(0, 0, 0.001);
  s.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {}}, {"wetness", wetness}};
  return s;
}

WetnessEffect& wetness_of(World& world) { return effect_of<WetnessEffect>(world, "wetness"); }

SettableField field_of(World& world) { return wetness_of(world).settable_fields().front(); }

TEST(Wetness, AddsTheMassOfItsWater) {
  for (const double w : {0.0, 0.5, 1.0}) {
    auto world = make_world(
        wet_cloth({{"wetness", std::to_string(w)}, {"capacity", "0.4"}, {"adhesion", "0"}}));
    const double mass = kDry + w * 0.4 * kArea;
    EXPECT_NEAR(particles_of(*world).mass.sum(), mass, 1e-15);
    EXPECT_NEAR(wetness_of(*world).water(), mass - kDry, 1e-15);
    run_for(*world, 0.1);
    EXPECT_NEAR(-world->reactions()[0].force.z(), 9.81 * mass, 1e-6 * mass);
  }
}

TEST(Wetness, IsSetInARegionAndShown) {
  auto world =
      make_world(wet_cloth({{"center", "[0.15, 0.15, 0]"}, {"radius", "0.12"}, {"from", "0.02"}}));
  EXPECT_EQ(wetness_of(*world).water(), 0.0);
  const Eigen::Matrix3Xf dry = body_of(*world).model->surface_colors();
  run_for(*world, 0.03);
  const Eigen::VectorXd shown = body_of(*world).model->point_fields().at("wetness");
  const Eigen::Matrix3Xf colors = body_of(*world).model->surface_colors();
  for (int i = 0; i < shown.size(); ++i) {
    const Eigen::Vector3d x = particles_of(*world).x.col(i);
    const bool is_within = (x - Eigen::Vector3d(0.15, 0.15, 0)).norm() <= 0.12;
    EXPECT_EQ(shown[i], is_within ? 1.0 : 0.0) << i;
    EXPECT_EQ(colors.col(i).sum() < 0.6f * dry.col(i).sum(), is_within) << i;
  }
  EXPECT_EQ(shown.sum(), 8.0);  // of the 7 x 7 vertices, 5 cm apart
}

TEST(Wetness, ComesEvenlyOverItsDuration) {
  auto world = make_world(wet_cloth({{"wetness", "0.8"}, {"from", "0.05"}, {"duration", "0.1"}}));
  for (int k = 1; k <= 40; ++k) {
    ASSERT_TRUE(world->step());
    const double share = std::clamp((k * 0.005 - 0.05 + 0.005) / 0.1, 0.0, 1.0);
    EXPECT_NEAR(wetness_of(*world).wetness()[0], 0.8 * share, 1e-12) << k;
  }
}

TEST(Wetness, ALiquidObstacleWetsAndStopsNothing) {
  ClothScene s = wet_cloth({{"wetness", "0"}});
  s.pose = at(0, 0, 0.1);
  // Its side is between two columns of vertices.
  s.obstacles.push_back(obstacle(Box({0.22, 0.4, 0.04}), at(0.1, 0, 0.05)));
  s.obstacles.back().liquid = true;
  auto world = make_world(s);
  run_for(*world, 0.3);
  const Positions& x = particles_of(*world).x;
  EXPECT_NEAR(x.row(2).maxCoeff(), 0.001, 1e-6) << "it fell through the pool onto the ground";
  for (int i = 0; i < x.cols(); ++i) {
    EXPECT_EQ(wetness_of(*world).wetness()[i], x(0, i) > -0.01 ? 1.0 : 0.0);
  }
  EXPECT_TRUE(world->reactions()[1].force.isZero(0.0));
}

TEST(Wetness, DriesAtItsRate) {
  auto world = make_world(wet_cloth({{"drying", "0.05"}, {"capacity", "0.2"}, {"wetness", "0.5"}}));
  run_for(*world, 1.0);
  EXPECT_NEAR(wetness_of(*world).water(), (0.1 - 0.05) * kArea, 1e-12);
  // The solver's masses lag behind by no more than one percent.
  EXPECT_NEAR(particles_of(*world).mass.sum(), (0.15 + 0.05) * kArea, 0.01 * 0.2 * kArea);
  run_for(*world, 2.0);
  EXPECT_EQ(wetness_of(*world).water(), 0.0);
  EXPECT_NEAR(particles_of(*world).mass.sum(), kDry, 1e-15);
}

// Hanging under a plate it sticks while its pull is above its weight.
TEST(Wetness, SinksTheWayThatGravityPulls) {
  ClothScene s = wet_cloth({{"wetness", "0.7"}, {"drainage", "0.01"}, {"adhesion", "0"}});
  s.pose = at(0, 0, 1) * Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX());
  s.fixed = {42, 48};  // it hangs
  auto world = make_world(s);
  run_for(*world, 0.5);
  const SettableField field = field_of(*world);
  const Positions& x = particles_of(*world).x;
  double top = 0.0, bottom = 0.0;  // of the halves
  for (int i = 0; i < x.cols(); ++i) {
    (x(2, i) > x.row(2).mean() ? top : bottom) += field.value(i) - 0.7;
  }
  EXPECT_LT(top, -0.1);
  EXPECT_GT(bottom, top);
}

TEST(Wetness, HoldsUnderAPlateUpToItsPull) {
  for (const bool holds : {true, false}) {
    const double weight = 9.81 * (0.15 + 0.2);  // per area [Pa]
    Eigen::Isometry3d turned = at(0, 0, 0.2);
    turned.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    ClothScene s = wet_cloth({{"adhesion", std::to_string(weight * (holds ? 1.05 : 0.95))}});
    s.obstacles = {obstacle(Plane(), turned)};
    s.pose = at(0, 0, 0.199);
    auto world = make_world(s);
    run_for(*world, 0.2);
    const double top = particles_of(*world).x.row(2).minCoeff();
    if (holds) {
      EXPECT_NEAR(top, 0.199, 1e-9);
      EXPECT_NEAR(-world->reactions()[0].force.z(), weight * kArea, 1e-6 * weight * kArea);
    } else {
      EXPECT_LT(top, 0.19) << "it should have fallen";
    }
  }
}

TEST(Wetness, DryClothSticksToNothing) {
  Eigen::Isometry3d turned = at(0, 0, 0.2);
  turned.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  ClothScene s = wet_cloth({{"wetness", "0"}});
  s.obstacles = {obstacle(Plane(), turned)};
  s.pose = at(0, 0, 0.199);
  auto world = make_world(s);
  run_for(*world, 0.1);
  // Free fall, by implicit Euler g h² n (n + 1)/2.
  EXPECT_NEAR(particles_of(*world).x(2, 0), 0.199 - 9.81 * 0.005 * 0.005 * 20 * 21 / 2.0, 1e-9);
}

// On a slope: tan of the angle of friction is the coefficient times the factor.
TEST(Wetness, RaisesFriction) {
  for (const double degrees : {38.0, 52.0}) {  // 45 with 0.5 times 2
    Eigen::Isometry3d tilt = Eigen::Isometry3d::Identity();
    tilt.linear() =
        Eigen::AngleAxisd(degrees * M_PI / 180.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
    ClothScene s = wet_cloth({{"adhesion", "0"}, {"friction_factor", "2"}});
    s.obstacles = {obstacle(Plane(), tilt)};
    s.pose = tilt * at(0, 0, 0.001);
    auto world = make_world(s);
    const Positions start = particles_of(*world).x;
    run_for(*world, 0.3);
    const double travel = (particles_of(*world).x - start).colwise().norm().maxCoeff();
    const double slope = std::sin(degrees * M_PI / 180.0) - std::cos(degrees * M_PI / 180.0);
    if (slope < 0.0) {
      EXPECT_LT(travel, 1e-6);
    } else {
      EXPECT_NEAR(travel, 0.5 * 9.81 * slope * 0.3 * 0.3, 0.1 * travel);
    }
  }
}

TEST(Wetness, ClosesTheWeaveToAir) {
  auto world = make_world(wet_cloth({{"permeability", "1e-3"}}));
  const SettableField field = field_of(*world);
  double before = INFINITY;
  for (const double w : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    field.set(0, w);
    const double now = wetness_of(*world).permeability(0);
    EXPECT_LT(now, before);
    before = now;
    EXPECT_DOUBLE_EQ(now, 1e-3 * (1.0 - w) * (1.0 - w) * (1.0 - w * w));
  }
  EXPECT_EQ(before, 0.0);
}

TEST(Wetness, IsAFieldThatUsersMaySet) {
  auto world = make_world(wet_cloth({{"wetness", "0"}}));
  const SettableField field = field_of(*world);
  EXPECT_EQ(field.spec.name, "wetness");
  const double before = particles_of(*world).mass[3];
  field.set(3, 1.0);
  EXPECT_EQ(field.value(3), 1.0);
  EXPECT_GT(particles_of(*world).mass[3], 1.5 * before);
  ASSERT_TRUE(world->step());
}

TEST(Wetness, ResetAndLoadRestoreIt) {
  ClothScene s = wet_cloth({{"wetness", "0.6"},
                            {"drying", "0.05"},
                            {"diffusion", "1e-4"},
                            {"center", "[0, 0, 0]"},
                            {"radius", "0.1"}});
  s.solver = "chebyshev";
  s.pose = at(0, 0, 0.02);
  auto world = make_world(s);
  const Eigen::VectorXd mass = particles_of(*world).mass;
  run_for(*world, 0.1);
  const Checkpoint saved = world->save();
  run_for(*world, 0.2);
  const Eigen::VectorXd wet = wetness_of(*world).wetness();
  const Positions x = particles_of(*world).x;
  world->load(saved);
  run_for(*world, 0.2);
  EXPECT_EQ(wetness_of(*world).wetness(), wet);
  EXPECT_EQ(particles_of(*world).x, x);
  world->reset();
  EXPECT_EQ(particles_of(*world).mass, mass);
}

TEST(Wetness, RefusesBadParameters) {
  const auto refuse = [](const ParameterText& text, const std::vector<std::string>& parts) {
    expect_refusal([&] { make_world(wet_cloth(text)); }, parts);
  };
  refuse({{"wetness", "1.1"}}, {"'wetness'", "<= 1"});
  refuse({{"capacity", "0"}}, {"'capacity'", "> 0", "kg/m^2"});
  refuse({{"adhesion", "-1"}}, {"'adhesion'", "Pa"});
  refuse({{"adhesion_range", "0"}}, {"'adhesion_range'", "[m]"});
  refuse({{"wettness", "1"}}, {"wettness", "wetness"});
}

}  // namespace
}  // namespace pliant
