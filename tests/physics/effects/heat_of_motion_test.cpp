// What viscosity, damping and friction take of a body's motion becomes its heat: an isolated body
// keeps the sum of its mechanical energy and its heat, to the order of its time integration.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "pliant/effects/particles/heat.h"
#include "pliant/solvers/time/time_integrations.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/particle_bodies.h"
#include "support/worlds/worlds.h"

namespace pliant::heat_of_motion_test {
namespace {

constexpr double kSpacing = 0.01;
constexpr double kFriction = 0.5, kSlides = 0.5;  // [1], [m/s]

HeatEffect& heat_of(ParticleWorld& t) {
  return dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
}

/// Without air and walls that take heat.
void add_heat(ParticleWorld& t, const char* temperature) {
  t.add_effect(
      "heat",
      {{"initial_temperature", temperature}, {"melting_point", "300"}, {"convection", "0"}});
}

/// A liquid stirred in a closed box that is one spacing wider than it on each side of a lattice.
std::unique_ptr<ParticleWorld> stirred(double dt, double viscosity, bool with_xsph,
                                       bool with_heat) {
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.sound_speed = 10.0;
  material.liquid.viscosity = viscosity;
  const Eigen::Vector3i counts(7, 7, 7);
  auto world = std::make_unique<ParticleWorld>(lattice_body(counts, kSpacing), material, dt);
  ParticleWorld& t = *world;
  const Eigen::Vector3d size = kSpacing * counts.cast<double>();
  add_basin(t, size);
  t.add_box({1.0, 1.0, 0.1}, {0.0, 0.0, size.z() + 0.05});
  t.add_effect("contact", {{"thickness", "1e-6"}, {"margin", "0"}});
  if (with_xsph) t.add_effect("xsph", {{"rate", "50"}});
  if (with_heat) add_heat(t, "320");
  t.start();
  const Eigen::Vector3d middle = t.particles().center_of_mass();
  for (int i = 0; i < t.particles().size(); ++i) {
    const Eigen::Vector3d from = t.particles().x.col(i) - middle;
    t.particles().v.col(i) =
        10.0 * Eigen::Vector3d::UnitZ().cross(from) * std::sin(60.0 * from.norm());
  }
  return world;
}

struct Balance {
  double error = 0.0;  ///< largest change of the sum, over the first mechanical energy
  double lost = 0.0;   ///< share of the mechanical energy that became heat
};

/// Of 0.1 s.
Balance stirred_balance(double dt, double viscosity, bool with_xsph) {
  const auto world = stirred(dt, viscosity, with_xsph, true);
  ParticleWorld& t = *world;
  const double before = heat_of(t).total_heat();
  Balance balance;
  double first = 0.0;
  while (t.world().time() < 0.1) {
    const Eigen::Matrix3Xd v = t.particles().v;
    const double heat = heat_of(t).total_heat() - before;
    EXPECT_TRUE(t.world().step()) << t.world().failure();
    EXPECT_EQ(t.body().substeps, 1);
    // In the middle of the step: Σ V c² ρ⁰ (ln ψ + 1/ψ − 1) at its start, velocities and heat half
    // a step before and after that.
    const Liquid& liquid = t.model().system().liquid;
    double energy = 0.5 * (heat + heat_of(t).total_heat() - before);
    for (int i = 0; i < t.particles().size(); ++i) {
      const double psi = std::max(1.0, liquid.last_filling()[i]);
      energy += liquid.volumes()[i] * 1000.0 * 100.0 * (std::log(psi) + 1.0 / psi - 1.0);
      const Eigen::Vector3d mean = 0.5 * (v.col(i) + t.particles().v.col(i));
      energy += 0.5 * t.particles().mass[i] * mean.squaredNorm();
    }
    if (first == 0.0) first = energy;
    balance.error = std::max(balance.error, std::abs(energy - first) / first);
  }
  EXPECT_NEAR(heat_of(t).total_heat() - before, heat_of(t).heat_from_motion(), 1e-9 * before);
  balance.lost = heat_of(t).heat_from_motion() / first;
  return balance;
}

TEST(HeatOfMotion, AStirredLiquidKeepsMechanicalEnergyAndHeat) {
  for (const bool with_xsph : {false, true}) {
    const Balance coarse = stirred_balance(4e-4, 0.5, with_xsph);
    const Balance fine = stirred_balance(2e-4, 0.5, with_xsph);
    std::printf("stirred %d: %g lost %g; %g lost %g\n", with_xsph, coarse.error, coarse.lost,
                fine.error, fine.lost);
    EXPECT_GT(fine.lost, 0.5);
    EXPECT_LT(coarse.error, 0.02);
    EXPECT_LT(fine.error, 0.35 * coarse.error);
  }
}

/// A bar that is held at an end and swings for 0.2 s, damped.
Balance swinging_balance(double dt, const char* integration) {
  ViscoelasticModel::Material material;
  material.solid.young = 1e5;
  ParticleWorld t(lattice_body({10, 3, 3}, kSpacing), material, dt);
  t.add_effect("damping", {{"rate", "6"}});
  add_heat(t, "290");
  t.start("newton", {{"iterations", "30"}, {"tolerance", "1e-10"}});
  t.world().set_time_integration(t.body(), time_integrations(), integration);
  const double left = t.particles().x.row(0).minCoeff();
  for (int i = 0; i < t.particles().size(); ++i) {
    const double from = t.particles().x(0, i) - left;
    if (from < 1.5 * kSpacing) {
      t.particles().fix(i);
    } else {
      t.particles().v(2, i) = 20.0 * from * from / 0.1;
    }
  }
  t.world().system_changed();
  const double heat = heat_of(t).total_heat();
  const auto mechanical = [&] {
    const Energies e = t.world().energies();
    return e.kinetic + e.elastic;
  };
  const double first = mechanical();
  EXPECT_EQ(t.run_until(0.2), "");
  Balance balance;
  balance.lost = (heat_of(t).total_heat() - heat) / first;
  balance.error = std::abs(mechanical() / first + balance.lost - 1.0);
  EXPECT_NEAR(balance.lost * first, heat_of(t).heat_from_motion(), 1e-9 * heat);
  return balance;
}

TEST(HeatOfMotion, ADampedSwingingSolidKeepsMechanicalEnergyAndHeat) {
  struct Order {
    const char* integration;
    double dt;
    double most;   ///< error at half of this step
    double share;  ///< of the error that half the step leaves, at most
  };
  // Implicit Euler itself takes motion, in proportion to the step where that is short for the
  // fastest swings; nothing accounts for it.
  for (const Order& order :
       {Order{"implicit_euler", 5e-4, 0.15, 0.7}, Order{"midpoint", 2e-3, 5e-4, 0.35}}) {
    const Balance coarse = swinging_balance(order.dt, order.integration);
    const Balance fine = swinging_balance(0.5 * order.dt, order.integration);
    std::printf("%s: %g lost %g; %g lost %g\n", order.integration, coarse.error, coarse.lost,
                fine.error, fine.lost);
    EXPECT_GT(fine.lost, 0.3);
    EXPECT_LT(fine.error, order.most) << order.integration;
    EXPECT_LT(fine.error, order.share * coarse.error) << order.integration;
  }
}

/// What a block that slides over a rough floor until it rests gets of its first motion as heat.
double share_of_slide(double dt, bool floor_takes_heat) {
  ViscoelasticModel::Material material;
  material.solid.young = 1e6;
  ParticleWorld t(lattice_body({6, 6, 3}, kSpacing), material, dt);
  t.add_box({4.0, 4.0, 0.1}, {0.0, 0.0, -0.05});
  if (floor_takes_heat) t.world().obstacles().back().temperature = 290.0;
  t.add_effect("gravity");
  t.add_effect("contact", {{"thickness", "0.01"}});
  t.add_effect("friction", {{"coefficient", std::to_string(kFriction)}});
  add_heat(t, "290");
  t.start("newton", {{"iterations", "30"}, {"tolerance", "1e-10"}});
  for (int i = 0; i < t.particles().size(); ++i) t.particles().v(0, i) = kSlides;
  const double first = t.world().energies().kinetic;
  EXPECT_EQ(t.run_until(1.5 * kSlides / (kFriction * 9.81)), "");
  EXPECT_LT(t.world().energies().kinetic, 1e-6 * first) << "it rests";
  return heat_of(t).heat_from_motion() / first;
}

// An implicit step takes ½ m Δv² beside the work of friction: μ g h / v of the motion in all.
TEST(HeatOfMotion, FrictionOnAFloorBecomesHeatOfWhichAWarmFloorTakesHalf) {
  for (const double dt : {2e-3, 1e-3}) {
    const double expected = 1.0 - kFriction * 9.81 * dt / kSlides;
    EXPECT_NEAR(share_of_slide(dt, false), expected, 0.2 * (1.0 - expected)) << dt;
    EXPECT_NEAR(share_of_slide(dt, true), 0.5 * expected, 0.1 * (1.0 - expected)) << dt;
  }
}

/// Of blocks of a scene file that slide over a plane until they rest: what becomes heat, over what
/// is expected of their motions.
double heat_of_slides(const std::vector<double>& speeds, const std::string& more_bodies,
                      const std::string& more_effects) {
  constexpr double kStep = 0.002;
  std::string text = fmt::format("time_step: {}\nbodies:\n{}", kStep, more_bodies);
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    text += fmt::format(
        "  - {{name: block{0}, model: viscoelastic, geometry: {{block: {{size: [0.06, 0.06, "
        "0.03]}}, spacing: 0.01}}, position: [0, {1}, 0.0153], velocity: [{2}, 0, 0], material: "
        "{{young: 1.0e+6}}}}\n",
        k, 0.3 * static_cast<double>(k), speeds[k]);
  }
  text +=
      "obstacles: [{name: ground, shape: plane}]\neffects:\n  gravity: {}\n" + more_effects +
      fmt::format("  contact: {{thickness: 0.01}}\n  friction: {{coefficient: {}}}\n", kFriction) +
      "  heat: {initial_temperature: 290, melting_point: 300, convection: 0}\n"
      "solver: {name: newton, iterations: 30, tolerance: 1.0e-10}\n";
  const auto world = world_of(text);
  run_for(*world, 0.14);
  // An implicit substep takes that share of the time.
  const double substep = kStep / world->bodies().front().substeps;
  const double mass = 1000.0 * 0.06 * 0.06 * 0.03;
  double expected = 0.0;
  for (const double speed : speeds) {
    const double lost = kFriction * 9.81 * substep / std::abs(speed);
    expected += 0.5 * mass * speed * speed * (1.0 - lost);
  }
  double heat = 0.0;
  for (Body& body : world->bodies()) {
    const auto* effect = dynamic_cast<HeatEffect*>(body.find_effect("heat"));
    if (effect != nullptr) heat += effect->heat_from_motion();
  }
  return heat / expected;
}

TEST(HeatOfMotion, BodiesInOneSystemAndInAGroupGetTheHeatOfTheirOwnFriction) {
  // Friction that ends within a step ends the motion there: one step of 50 is uncertain.
  EXPECT_NEAR(heat_of_slides({0.5}, "", ""), 1.0, 0.01);
  EXPECT_NEAR(heat_of_slides({0.5, -0.3}, "", ""), 1.0, 0.01);
  // Beside a body of another model, which has no heat, with the particles of both in one system.
  const std::string soft =
      "  - {name: soft, model: patch, geometry: {block: {size: [0.05, 0.05, 0.05], cells: [2, 2, "
      "2]}}, position: [0, -0.3, 0.03], velocity: [0.4, 0, 0], material: {young: 1.0e+5}}\n";
  EXPECT_NEAR(heat_of_slides({0.5}, soft, "  body_contact: {}\n"), 1.0, 0.01);
}

TEST(HeatOfMotion, HeatsWhereItIsRubbedAndMovesNothing) {
  const auto with = stirred(4e-4, 0.5, true, true), without = stirred(4e-4, 0.5, true, false);
  ASSERT_EQ(with->run_until(0.05), "");
  ASSERT_EQ(without->run_until(0.05), "");
  EXPECT_EQ(with->particles().x, without->particles().x);
  EXPECT_EQ(with->particles().v, without->particles().v);
  const Eigen::VectorXd& warm = heat_of(*with).temperatures();
  EXPECT_GT(warm.maxCoeff() - 320.0, 2.0 * (warm.minCoeff() - 320.0));
  with->world().reset();
  EXPECT_EQ(heat_of(*with).heat_from_motion(), 0.0);
}

}  // namespace
}  // namespace pliant::heat_of_motion_test
