#include <gtest/gtest.h>

#include "pliant/effects/particles/xsph.h"
#include "pliant/laws/sph_kernels.h"
#include "pliant/math/error.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

TEST(SurfaceTension, HasTheEnergyOfTheSurfaceItMakes) {
  // Two cubes apart have two faces more than together: 2 σ L². By the kernel sum of particles,
  // whose outermost half spacing counts like the inner ones: to a tenth.
  const double side = 0.12, tension = 0.05;
  const BodyGeometry cube = sampled_box({side, side, side}, 0.01);
  const auto energy = [&](double distance) {
    ParticleWorld t(cube, liquid_material(), 0.01);
    t.add(cube, liquid_material(), {side + distance, 0.0, 0.0});
    t.add_effect("surface_tension", {{"tension", "0.05"}});
    return t.world().energies().potential;
  };
  const double made = energy(0.1) - energy(0.0);
  EXPECT_NEAR(made, 2.0 * tension * side * side, 0.1 * 2.0 * tension * side * side);
}

TEST(SurfaceTension, RoundsADropAndKeepsMomentum) {
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.viscosity = 0.2;
  material.liquid.sound_speed = 3.0;
  ParticleWorld t(sampled_box({0.08, 0.05, 0.05}, 0.01), material, 0.005);
  t.add_effect("surface_tension", {{"tension", "1"}});
  t.start();
  ASSERT_EQ(t.run_until(1.5), "");
  const Positions& x = t.particles().x;
  const Eigen::Vector3d size = x.rowwise().maxCoeff() - x.rowwise().minCoeff();
  EXPECT_LT(size.maxCoeff() / size.minCoeff(), 1.25) << "from 1.6: " << size.transpose();
  const double scale = t.particles().mass.sum() * 0.1;
  EXPECT_LT(t.particles().momentum().norm(), 1e-12 * scale);
}

TEST(Xsph, TakesTheJitterAndKeepsMomentum) {
  const auto kinetic = [](bool smooth) {
    ParticleWorld t(sampled_box({0.06, 0.06, 0.06}, 0.01), liquid_material(), 0.001);
    if (smooth) t.add_effect("xsph", {{"rate", "50"}});
    t.start();
    unsigned state = 3;
    for (Eigen::Index k = 0; k < t.particles().v.size(); ++k) {
      state = 1664525u * state + 1013904223u;
      t.particles().v.data()[k] = 0.01 * (static_cast<double>(state) / 4294967296.0 - 0.5);
    }
    const Eigen::Vector3d before = t.particles().momentum();
    EXPECT_EQ(t.run_until(0.03), "");
    EXPECT_LT((t.particles().momentum() - before).norm(), 1e-10 * before.norm());
    return t.particles().kinetic_energy();
  };
  EXPECT_LT(kinetic(true), 0.5 * kinetic(false));
}

/// Two drops of a cubic centimetre, a centimetre apart, of these densities; the first is still, the
/// other goes past it at 1 m/s.
struct TwoDrops {
  TwoDrops(double first, double other) : t(1e-3) {
    BodyGeometry drop;
    drop.interior_points = Eigen::Matrix3Xd::Zero(3, 1);
    drop.volume = kVolume;
    ViscoelasticModel::Material material = liquid_material();
    material.liquid.density = first;
    t.add(drop, material);
    material.liquid.density = other;
    t.add(drop, material, {kApart, 0.0, 0.0}, {0.0, 1.0, 0.0});
  }
  /// The speeds after so long with this rate.
  Eigen::Vector2d speeds_after(double rate, double dt) {
    XsphEffect(t.model(), rate).after_step(t.body(), dt);
    return t.particles().v.row(1).transpose();
  }

  static constexpr double kVolume = 1e-6, kApart = 0.01;
  ParticleWorld t;
};

TEST(Xsph, TakesTheShareOfItsRateAndStep) {
  for (const double rate : {1.0, 4.0}) {
    for (const double dt : {1e-3, 1e-2}) {
      TwoDrops drops(1000.0, 1000.0);
      const double weight = SphKernels(drops.t.model().support()).poly6(1e-4) * TwoDrops::kVolume;
      ASSERT_GT(weight, 0.01) << "they do not feel each other";
      const Eigen::Vector2d speeds = drops.speeds_after(rate, dt);
      EXPECT_NEAR(speeds[0], rate * dt * weight, 1e-14) << rate << " " << dt;
      EXPECT_NEAR(speeds[1], 1.0 - rate * dt * weight, 1e-14) << rate << " " << dt;
    }
  }
}

// However much its neighbour weighs: impulses are those of the lighter one.
TEST(Xsph, NeverTurnsALightDropBackFromAHeavyOne) {
  for (const double light : {1.0, 100.0}) {
    TwoDrops drops(1000.0, light);
    const Eigen::Vector3d before = drops.t.particles().momentum();
    const double energy = drops.t.particles().kinetic_energy();
    const Eigen::Vector2d speeds = drops.speeds_after(1e6, 1e-3);
    EXPECT_GE(speeds[0], 0.0);
    EXPECT_LT(speeds[0], speeds[1]);
    EXPECT_LT(speeds[1], 1.0);
    EXPECT_LT(drops.t.particles().kinetic_energy(), energy);
    EXPECT_LE((drops.t.particles().momentum() - before).norm(), 1e-14 * before.norm());
  }
}

/// A bar that is pressed together by a third for a second, and let go: its length over that at
/// rest.
double length_after_pressing(const std::vector<ParameterText>& plasticity) {
  ViscoelasticModel::Material material;
  ParticleWorld t(lattice_body({8, 4, 4}, 0.01), material, 0.01);
  for (const ParameterText& parameters : plasticity) t.add_effect("plasticity", parameters);
  t.add_effect("damping", {{"rate", "20"}});
  t.start("gauss_seidel", {{"iterations", "20"}});
  const auto length = [&] {
    return t.particles().x.row(0).maxCoeff() - t.particles().x.row(0).minCoeff();
  };
  const double rest = length();
  t.particles().x.row(0) *= 2.0 / 3.0;
  for (int i = 0; i < t.particles().size(); ++i) t.particles().fix(i);
  t.world().system_changed();
  EXPECT_EQ(t.run_until(1.0), "");
  const double energy = t.world().energies().elastic;
  for (int i = 0; i < t.particles().size(); ++i) t.particles().release(i);
  t.world().system_changed();
  EXPECT_EQ(t.run_until(3.0), "");
  EXPECT_LE(t.world().energies().elastic, energy);
  return length() / rest;
}

TEST(Plasticity, SpringsBackUpToTheYieldAndKeepsTheRest) {
  EXPECT_NEAR(length_after_pressing({}), 1.0, 0.01);
  EXPECT_NEAR(length_after_pressing({{{"yield", "0.5"}}}), 1.0, 0.01) << "not reached";
  EXPECT_NEAR(length_after_pressing({{{"yield", "0"}, {"rate", "10"}}}), 2.0 / 3.0, 0.02);
  const double part = length_after_pressing({{{"yield", "0.1"}}});
  EXPECT_GT(part, 2.0 / 3.0 + 0.02);
  EXPECT_LT(part, 0.95);
}

TEST(ParticleEffects, RefuseWhatCannotBe) {
  ParticleWorld t(lattice_body({2, 2, 2}, 0.01), {}, 0.01);
  EXPECT_THROW(t.add_effect("surface_tension", {{"tension", "-1"}}), InputError);
  EXPECT_THROW(t.add_effect("xsph", {{"rate", "-1"}}), InputError);
  EXPECT_THROW(t.add_effect("plasticity", {{"yield", "-1"}}), InputError);
  EXPECT_THROW(t.add_effect("plasticity", {{"yeild", "1"}}), InputError);
}

}  // namespace
}  // namespace pliant
