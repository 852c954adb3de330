#include <gtest/gtest.h>

#include <cmath>

#include "pliant/effects/particles/heat.h"
#include "support/worlds/particle_bodies.h"

namespace pliant::melting_test {
namespace {

HeatEffect& heat_of(ParticleWorld& t) {
  return dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
}

TEST(Melting, TheFrontOfAStefanProblemMovesAsInClosedForm) {
  // One phase: at its melting point T_m, from t = 0 on heated by a wall of T_w. The front is at
  //   s = 2 λ √(a t),  λ exp(λ²) erf(λ) = St/√π,  St = c (T_w − T_m)/L, a = k/(ρ c).
  const double capacity = 2000.0, conductivity = 200.0, latent = 1e5, wall = 350.0, melting = 300.0;
  const double stefan = capacity * (wall - melting) / latent;
  double lambda = 0.5;
  for (int k = 0; k < 50; ++k) {
    const double f =
        lambda * std::exp(lambda * lambda) * std::erf(lambda) - stefan / std::sqrt(M_PI);
    const double slope =
        (1.0 + 2.0 * lambda * lambda) * std::exp(lambda * lambda) * std::erf(lambda) +
        2.0 * lambda / std::sqrt(M_PI);
    lambda -= f / slope;
  }
  const double diffusivity = conductivity / (1000.0 * capacity);
  ViscoelasticModel::Material material;
  const double spacing = 0.005;
  // Slow sound: the liquid, held in place here, then needs no short steps.
  material.liquid.sound_speed = 0.02;
  ParticleWorld t(lattice_body({14, 10, 10}, spacing), material, 0.05);
  Obstacle hot;
  hot.name = "wall";
  hot.shape = std::make_shared<Plane>();
  hot.pose_start.linear() =
      Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  hot.pose_end = hot.pose_start;
  hot.temperature = wall;
  t.world().add_obstacle(hot);
  t.add_effect("heat", {{"initial_temperature", "299.75"},
                        {"melting_point", "300"},
                        {"melting_range", "0.5"},
                        {"latent_heat", "1e5"},
                        {"capacity", "2000"},
                        {"conductivity", "200"},
                        {"convection", "0"}});
  t.start();
  // Held where it is: heat alone.
  for (int i = 0; i < t.particles().size(); ++i) t.particles().fix(i);
  t.world().system_changed();
  for (double time : {3.0, 5.0, 7.0}) {
    ASSERT_EQ(t.run_until(time), "");
    // Of the inner four by four rows, since outer ones lack neighbours on one side.
    double melted = 0.0;
    for (int i = 0; i < t.particles().size(); ++i) {
      const Eigen::Vector2d from = t.particles().x.col(i).tail<2>().array() - 5.0 * spacing;
      if (from.cwiseAbs().maxCoeff() < 2.0 * spacing)
        melted += t.model().beta()[i] / 16.0 * spacing;
    }
    const double exact = 2.0 * lambda * std::sqrt(diffusivity * time);
    EXPECT_NEAR(melted, exact, 0.05 * exact);
  }
}

TEST(Melting, TwoBodiesThatTouchTakeTheTemperatureOfTheirEffusivities) {
  // Two half spaces of temperatures T, T' that meet at x = 0. There it is from then on
  //   T_c = (e T + e' T')/(e + e'),  e = √(k ρ c),
  // and at a depth d  T_c + (T − T_c) erf(d/(2 √(a t))),  a = k/(ρ c).
  struct Half {
    double density, capacity, conductivity, temperature;
    double effusivity() const { return std::sqrt(conductivity * density * capacity); }
    double diffusivity() const { return conductivity / (density * capacity); }
  };
  const Half left{1000.0, 2000.0, 200.0, 290.0}, right{2000.0, 500.0, 50.0, 350.0};
  const double spacing = 0.005, time = 2.0;
  const auto material_of = [](const Half& half) {
    ViscoelasticModel::Material material;
    // Slow sound: held in place here, they need no short steps.
    material.liquid.sound_speed = 0.02;
    material.liquid.density = half.density;
    material.heat.capacity = half.capacity;
    material.heat.conductivity = half.conductivity;
    material.heat.initial_temperature = half.temperature;
    return material;
  };
  const Eigen::Vector3i counts(14, 6, 6);
  ParticleWorld t(lattice_body(counts, spacing), material_of(left), 0.05);
  t.add(lattice_body(counts, spacing), material_of(right), {spacing * counts[0], 0.0, 0.0});
  t.add_effect("heat", {{"melting_point", "500"}, {"convection", "0"}});
  t.start();
  for (int i = 0; i < t.particles().size(); ++i) t.particles().fix(i);
  t.world().system_changed();
  const double before = heat_of(t).total_heat();
  ASSERT_EQ(t.run_until(time), "");
  EXPECT_NEAR(heat_of(t).total_heat(), before, 1e-12 * before);
  const double contact =
      (left.effusivity() * left.temperature + right.effusivity() * right.temperature) /
      (left.effusivity() + right.effusivity());
  const double range = right.temperature - left.temperature;
  for (int i = 0; i < t.particles().size(); ++i) {
    // Of the inner two by two rows, since outer ones lack neighbours on one side.
    const Eigen::Vector2d from = t.particles().x.col(i).tail<2>().array() - 3.0 * spacing;
    if (from.cwiseAbs().maxCoeff() > spacing) continue;
    const double x = t.particles().x(0, i) - spacing * counts[0];
    const Half& half = x < 0.0 ? left : right;
    const double depth = std::abs(x) / (2.0 * std::sqrt(half.diffusivity() * time));
    const double exact = contact + (half.temperature - contact) * std::erf(depth);
    EXPECT_NEAR(heat_of(t).temperatures()[i], exact, 0.03 * range) << x;
  }
}

TEST(Melting, HeatMassAndMomentumAreKept) {
  ViscoelasticModel::Material material;
  ParticleWorld t(sampled_box({0.06, 0.05, 0.04}, 0.01), material, 0.01);
  t.add_effect("heat",
               {{"initial_temperature", "300"}, {"convection", "0"}, {"conductivity", "500"}});
  t.start("jacobi", {{"iterations", "30"}});
  HeatEffect& heat = heat_of(t);
  for (int i = 0; i < t.particles().size(); ++i) {
    heat.set_temperature(i, t.particles().x(0, i) > 0.0 ? 400.0 : 290.0);
    t.particles().v.col(i) = Eigen::Vector3d(0.1, 0.0, 0.2 * t.particles().x(0, i));
  }
  const double before = heat.total_heat(), mass = t.particles().mass.sum();
  const Eigen::Vector3d momentum = t.particles().momentum();
  ASSERT_EQ(t.run_until(0.5), "");
  EXPECT_NEAR(heat.total_heat() - heat.heat_from_strain() - heat.heat_from_motion(), before,
              1e-12 * before);
  EXPECT_EQ(t.particles().mass.sum(), mass);
  EXPECT_LT((t.particles().momentum() - momentum).norm(), 1e-10 * momentum.norm());
  EXPECT_GT(t.model().beta().maxCoeff(), 0.5);
  EXPECT_LT(t.model().beta().minCoeff(), 0.5);
}

TEST(Melting, WhatFreezesKeepsItsNewShapeAtRest) {
  ViscoelasticModel::Material material;
  material.liquid.viscosity = 2.0;
  material.liquid.sound_speed = 3.0;
  material.solid.young = 2e4;
  ParticleWorld t(sampled_box({0.06, 0.06, 0.06}, 0.01), material, 0.005);
  t.world().add_obstacle([] {
    Obstacle floor;
    floor.name = "floor";
    floor.shape = std::make_shared<Plane>();
    floor.pose_start.translation().z() = floor.pose_end.translation().z() = -0.031;
    return floor;
  }());
  t.add_effect("gravity");
  t.add_effect("contact", {{"thickness", "0.002"}});
  t.add_effect("friction");
  t.add_effect("damping", {{"rate", "5"}});
  t.start("jacobi", {{"iterations", "15"}});
  const double rest_height = t.particles().x.row(2).maxCoeff() + 0.03;
  for (int i = 0; i < t.particles().size(); ++i) t.model().set_beta(i, 1.0);
  ASSERT_EQ(t.run_until(0.6), "");
  EXPECT_EQ(t.model().system().solid().weights().maxCoeff(), 0.0) << "all left their clusters";
  EXPECT_EQ(t.world().energies().elastic, 0.0);
  const double melted_height = t.particles().x.row(2).maxCoeff() + 0.03;
  EXPECT_LT(melted_height, 0.8 * rest_height) << "it flowed";
  for (int i = 0; i < t.particles().size(); ++i) t.model().set_beta(i, 0.0);
  ASSERT_EQ(t.run_until(0.625), "");
  EXPECT_GT(t.model().system().solid().weights().minCoeff(), 0.0);
  const Positions frozen = t.particles().x;
  ASSERT_EQ(t.run_until(2.0), "");
  const double moved = (t.particles().x - frozen).colwise().norm().maxCoeff();
  const double weight_energy = 9.81 * t.particles().mass.sum() * 0.06;
  EXPECT_LT(moved, 0.01) << "within a particle's spacing";
  EXPECT_LT(t.world().energies().elastic, 0.01 * weight_energy);
  EXPECT_LT(t.world().energies().kinetic, 1e-5 * weight_energy);
}

}  // namespace
}  // namespace pliant::melting_test
