#include "pliant/effects/particles/heat.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pliant/math/error.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

TEST(HeatMaterial, EnthalpyAndTemperatureAreInverse) {
  const HeatMaterial material;
  double last = -1.0;
  for (double t = 250.0; t < 360.0; t += 0.5) {
    const double h = material.enthalpy(t);
    EXPECT_GT(h, last) << "it grows";
    last = h;
    EXPECT_NEAR(material.temperature(h), t, 1e-9);
  }
  EXPECT_NEAR(material.enthalpy(material.liquidus()) - material.enthalpy(material.solidus()),
              material.latent_heat + material.capacity * material.melting_range, 1e-6);
}

TEST(HeatEffect, SetsBetaFromTheTemperature) {
  for (const auto& [temperature, beta] :
       {std::pair("290", 0.0), std::pair("305", 0.5), std::pair("320", 1.0)}) {
    ParticleWorld t(lattice_body({3, 3, 3}, 0.01), {}, 0.01);
    t.add_effect("heat", {{"initial_temperature", temperature}});
    EXPECT_NEAR(t.model().beta().minCoeff(), beta, 1e-9);
    EXPECT_NEAR(t.model().beta().maxCoeff(), beta, 1e-9);
  }
}

TEST(HeatEffect, TheAirCoolsTheSurfaceByItsArea) {
  // A cube of side L loses h 6 L² (T − T_air).
  const double side = 0.1, convection = 50.0;
  ParticleWorld t(sampled_box({side, side, side}, 0.01), {}, 0.01);
  t.add_effect("heat", {{"initial_temperature", "300"},
                        {"melting_point", "400"},
                        {"air_temperature", "280"},
                        {"conductivity", "0"},
                        {"convection", "50"}});
  t.start();
  const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  const double before = heat.total_heat();
  ASSERT_EQ(t.run_until(0.1), "");
  const double exact = convection * 6.0 * side * side * 20.0 * 0.1;
  // Particles know the surface by what is missing about them: to a tenth.
  EXPECT_NEAR(before - heat.total_heat(), exact, 0.1 * exact);
}

TEST(HeatEffect, EachBodyMayHaveAMaterialOfItsOwn) {
  ViscoelasticModel::Material wax;
  wax.heat.melting_point = 330.0;
  wax.heat.capacity = 800.0;
  wax.heat.initial_temperature = 305.0;
  wax.heat.solid_beta = 0.25;
  ParticleWorld t(lattice_body({3, 3, 3}, 0.01), {}, 0.01);
  t.add(lattice_body({2, 2, 2}, 0.01), wax, {0.1, 0.0, 0.0});
  t.add_effect("heat",
               {{"initial_temperature", "305"}, {"capacity", "2000"}, {"latent_heat", "0"}});
  const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  EXPECT_NEAR(t.model().beta().head(27).maxCoeff(), 0.5, 1e-9) << "in the middle of its melting";
  EXPECT_NEAR(t.model().beta().tail(8).minCoeff(), 0.25, 1e-9);
  EXPECT_NEAR(t.model().beta().tail(8).maxCoeff(), 0.25, 1e-9);
  const double exact = 305.0 * 1e-3 * (27.0 * 2000.0 + 8.0 * 800.0);
  EXPECT_NEAR(heat.total_heat(), exact, 1e-9 * exact);
}

TEST(HeatEffect, AnyConvectionAndConductanceStayBetweenTheTemperatures) {
  for (const char* name : {"convection", "wall_conductance"}) {
    ParticleWorld t(lattice_body({4, 4, 4}, 0.01), {}, 0.01);
    Obstacle floor;
    floor.name = "floor";
    floor.shape = std::make_shared<Plane>();
    floor.temperature = 280.0;
    t.world().add_obstacle(floor);
    t.add_effect("heat",
                 {{"initial_temperature", "290"}, {"air_temperature", "280"}, {name, "1e9"}});
    t.start();
    const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
    const double before = heat.total_heat();
    ASSERT_EQ(t.run_until(0.1), "") << name;
    EXPECT_GE(heat.temperatures().minCoeff(), 280.0 - 1e-9) << name;
    EXPECT_LE(heat.temperatures().maxCoeff(), 290.0 + 1e-9) << name;
    EXPECT_NEAR(heat.temperatures().minCoeff(), 280.0, 0.1) << name << ": at the surface";
    const double change = heat.total_heat() - before;
    EXPECT_NEAR(heat.heat_from_outside(), change, 1e-12 * before) << name << ": all is accounted";
  }
}

/// A cube of particles on a hot plate, of a material that conducts so well that explicit substeps
/// of 10 ms would be billions.
std::unique_ptr<ParticleWorld> on_a_hot_plate() {
  ViscoelasticModel::Material light;
  light.liquid.density = 1.0;
  auto world = std::make_unique<ParticleWorld>(sampled_box({0.01, 0.01, 0.01}, 0.005), light, 0.01);
  ParticleWorld& t = *world;
  Obstacle plate;
  plate.name = "hot";
  plate.shape = std::make_shared<Plane>();
  plate.pose_start.translation().z() = plate.pose_end.translation().z() = -0.0055;
  plate.temperature = 1000.0;
  t.world().add_obstacle(plate);
  t.add_effect("heat", {{"initial_temperature", "300"},
                        {"melting_point", "5000"},
                        {"capacity", "0.01"},
                        {"conductivity", "1e6"},
                        {"latent_heat", "0"},
                        {"convection", "0"}});
  t.start();
  return world;
}

bool warns_of(const Body& body, const std::string& name) {
  return std::any_of(body.report.warnings.begin(), body.report.warnings.end(),
                     [&](const std::string& warning) { return warning.rfind(name, 0) == 0; });
}

TEST(HeatEffect, WhatConductsAtOnceTakesThePlatesTemperatureAndSaysHow) {
  const auto world = on_a_hot_plate();
  ParticleWorld& t = *world;
  const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  const double before = heat.total_heat();
  ASSERT_TRUE(t.world().step()) << t.world().failure();
  EXPECT_NEAR(heat.temperatures().minCoeff(), 1000.0, 1e-3);
  EXPECT_LE(heat.temperatures().maxCoeff(), 1000.0 + 1e-6);
  EXPECT_NEAR(heat.total_heat(), before * 1000.0 / 300.0, 1e-5 * before);
  EXPECT_NEAR(heat.heat_from_outside(), heat.total_heat() - before, 1e-9 * before);
  EXPECT_TRUE(warns_of(t.body(), "heat_implicit"));
  EXPECT_FALSE(warns_of(t.body(), "heat_not_converged"));
}

/// A block of 60 g that stands at 400 K in air of 300 K.
std::unique_ptr<ParticleWorld> cooling_block(const std::string& capacity,
                                             const std::string& conductivity) {
  auto world = std::make_unique<ParticleWorld>(sampled_box({0.05, 0.04, 0.03}, 0.01),
                                               ViscoelasticModel::Material(), 0.01);
  world->add_effect("heat", {{"initial_temperature", "400"},
                             {"melting_point", "5000"},
                             {"air_temperature", "300"},
                             {"capacity", capacity},
                             {"conductivity", conductivity},
                             {"latent_heat", "0"},
                             {"convection", "100"}});
  world->start();
  return world;
}

TEST(HeatEffect, WhatConductsAtOnceCoolsInTheAirAsOneLump) {
  // Of one temperature throughout: m c dT/dt = −h A (T − T_air).
  const auto heat_of = [](ParticleWorld& t) -> const HeatEffect& {
    return dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  };
  // h A, as the particles know their surface: of a block that hardly cools, by explicit steps.
  const auto slow = cooling_block("1e6", "0");
  ASSERT_EQ(slow->run_until(0.01), "");
  ASSERT_FALSE(warns_of(slow->body(), "heat_implicit"));
  const double conductance = -heat_of(*slow).heat_from_outside() / (100.0 * 0.01);
  const auto fast = cooling_block("1", "1e6");
  const HeatEffect& heat = heat_of(*fast);
  const double capacity = fast->particles().mass.sum();  // times 1 J/(kg K)
  for (const double time : {0.01, 0.05, 0.1}) {
    ASSERT_EQ(fast->run_until(time), "");
    ASSERT_TRUE(warns_of(fast->body(), "heat_implicit"));
    const double exact = 300.0 + 100.0 * std::exp(-time * conductance / capacity);
    EXPECT_NEAR(heat.total_heat() / capacity, exact, 0.005 * (400.0 - exact)) << time;
    EXPECT_LT(heat.temperatures().maxCoeff() - heat.temperatures().minCoeff(), 0.01);
    EXPECT_NEAR(heat.heat_from_outside(), heat.total_heat() - 400.0 * capacity,
                1e-9 * 400.0 * capacity);
  }
}

TEST(HeatEffect, ImplicitStepsKeepTheHeatOfEachBodyAloneWhileItMelts) {
  // Two bodies that do not touch, each half of it hot: each goes to its own mean enthalpy.
  ViscoelasticModel::Material material;
  ParticleWorld t(lattice_body({4, 3, 3}, 0.01), material, 0.01);
  t.add(lattice_body({4, 3, 3}, 0.01), material, {1.0, 0.0, 0.0});
  t.add_effect("heat", {{"initial_temperature", "300"},
                        {"conductivity", "1e6"},
                        {"convection", "0"},
                        {"melting_point", "350"},
                        {"melting_range", "2"},
                        {"latent_heat", "2e5"},
                        {"capacity", "100"}});
  t.start();
  auto& heat = dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
  // The first ends in the midst of melting, the second all liquid.
  for (int i = 0; i < 36; i += 2) heat.set_temperature(i, 500.0);
  for (int i = 36; i < 72; ++i) heat.set_temperature(i, i % 2 == 0 ? 4000.0 : 320.0);
  HeatMaterial expected;
  expected = {100.0, 1e6, 2e5, 350.0, 2.0};
  const double first =
      expected.temperature(0.5 * (expected.enthalpy(500.0) + expected.enthalpy(300.0)));
  const double second =
      expected.temperature(0.5 * (expected.enthalpy(4000.0) + expected.enthalpy(320.0)));
  ASSERT_NEAR(first, 350.0, 1.0);
  const double before = heat.total_heat();
  ASSERT_EQ(t.run_until(0.2), "");
  EXPECT_NEAR(heat.total_heat(), before, 1e-12 * before);
  EXPECT_EQ(heat.heat_from_outside(), 0.0);
  for (int i = 0; i < 72; ++i) {
    EXPECT_NEAR(heat.temperatures()[i], i < 36 ? first : second, i < 36 ? 1e-3 : 0.1) << i;
  }
}

TEST(HeatEffect, ImplicitAndExplicitStepsAgree) {
  // The same bar, with steps on either side of the limit.
  const auto ends = [](double dt) {
    ViscoelasticModel::Material material;
    ParticleWorld t(lattice_body({20, 2, 2}, 0.01), material, dt);
    t.add_effect("heat", {{"initial_temperature", "300"},
                          {"melting_point", "5000"},
                          {"capacity", "1"},
                          {"conductivity", "1000"},
                          {"latent_heat", "0"},
                          {"convection", "0"}});
    t.start();
    auto& heat = dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
    for (int i = 0; i < t.particles().size(); ++i) {
      if (t.particles().x(0, i) < 0.1) heat.set_temperature(i, 400.0);
    }
    EXPECT_EQ(t.run_until(0.008), "");
    return std::pair(Eigen::VectorXd(heat.temperatures()), warns_of(t.body(), "heat_implicit"));
  };
  const auto [fine, fine_implicit] = ends(0.0005);
  const auto [coarse, coarse_implicit] = ends(0.008);
  EXPECT_FALSE(fine_implicit);
  EXPECT_TRUE(coarse_implicit);
  EXPECT_GT(fine.maxCoeff() - fine.minCoeff(), 10.0) << "it has not levelled yet";
  EXPECT_LT((fine - coarse).cwiseAbs().maxCoeff(), 1.0);
}

TEST(HeatEffect, ExplicitStepsStayBetweenTheTemperaturesOnAPerfectWall) {
  // What conducts as fast as explicit steps just take, and gives all it has to the wall.
  ParticleWorld t(sampled_box({0.05, 0.05, 0.05}, 0.01), {}, 1e-3);
  Obstacle plate;
  plate.name = "cold";
  plate.shape = std::make_shared<Plane>();
  plate.pose_start.translation().z() = plate.pose_end.translation().z() = -0.026;
  plate.temperature = 0.0;
  t.world().add_obstacle(plate);
  t.add_effect("heat", {{"initial_temperature", "300"},
                        {"melting_point", "5000"},
                        {"latent_heat", "0"},
                        {"conductivity", "1e6"},
                        {"convection", "0"},
                        {"wall_conductance", "1e12"}});
  t.start();
  const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  for (int step = 0; step < 300; ++step) {
    ASSERT_TRUE(t.world().step()) << t.world().failure();
    ASSERT_FALSE(warns_of(t.body(), "heat_implicit"));
    ASSERT_GE(heat.temperatures().minCoeff(), -1e-9) << step;
    ASSERT_LE(heat.temperatures().maxCoeff(), 300.0 + 1e-9) << step;
  }
}

/// A block that is held stretched by a tenth along x, or as it was made; nothing conducts.
std::unique_ptr<ParticleWorld> held_block(bool stretched, bool oriented, const char* creep_rate) {
  ViscoelasticModel::Material material;
  material.solid.young = 1e6;
  material.oriented = oriented;
  auto world = std::make_unique<ParticleWorld>(lattice_body({8, 3, 3}, 0.01), material, 0.01);
  ParticleWorld& t = *world;
  t.add_effect("plasticity", {{"yield", "0.01"}, {"rate", creep_rate}});
  t.add_effect("heat", {{"initial_temperature", "290"},
                        {"capacity", "1"},
                        {"latent_heat", "0"},
                        {"conductivity", "0"},
                        {"convection", "0"}});
  t.start();
  for (int i = 0; i < t.particles().size(); ++i) t.particles().fix(i);
  t.world().system_changed();
  if (stretched) t.particles().x.row(0) *= 1.1;
  return world;
}

TEST(HeatEffect, WhatMeltingTakesOfTheStrainWarmsWhatMelts) {
  for (const bool oriented : {false, true}) {
    const auto world = held_block(true, oriented, "0");
    ParticleWorld& t = *world;
    auto& heat = dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
    // Turns come nearly to rest first: their motion loses energy of its own.
    ASSERT_EQ(t.run_until(0.5), "");
    const double strained = t.world().energies().elastic;
    const double error = (oriented ? 1e-4 : 1e-9) * strained;
    ASSERT_GT(strained, 0.1);
    // The end at the largest x melts.
    for (int i = 0; i < t.particles().size(); ++i) {
      if (t.particles().x(0, i) > 0.07) heat.set_temperature(i, 320.0);
    }
    const double before = heat.total_heat();
    ASSERT_EQ(t.run_until(0.55), "");
    const double lost = strained - t.world().energies().elastic;
    EXPECT_GT(lost, 0.05 * strained) << oriented;
    EXPECT_NEAR(heat.heat_from_strain(), lost, error) << oriented;
    EXPECT_NEAR(heat.total_heat() - before, heat.heat_from_strain(), 1e-9 * before) << oriented;
    EXPECT_GT(heat.temperatures().maxCoeff(), 320.0 + 1.0) << oriented;
    for (int i = 0; i < t.particles().size(); ++i) {
      // No cluster of these reaches what melted.
      if (t.particles().x(0, i) > 0.02) continue;
      EXPECT_NEAR(heat.temperatures()[i], 290.0, 1e-9);
    }
    // Then all of it: nothing of the strain is left.
    for (int i = 0; i < t.particles().size(); ++i) heat.set_temperature(i, 320.0);
    ASSERT_EQ(t.run_until(0.6), "");
    EXPECT_EQ(t.world().energies().elastic, 0.0);
    EXPECT_NEAR(heat.heat_from_strain(), strained, error) << oriented;
    t.world().reset();
    EXPECT_EQ(heat.heat_from_strain(), 0.0);
  }
}

TEST(HeatEffect, WhatCreepTakesOfTheStrainWarmsTheBody) {
  const auto world = held_block(true, false, "20");
  ParticleWorld& t = *world;
  const auto& heat = dynamic_cast<const HeatEffect&>(*t.body().find_effect("heat"));
  const double strained = t.world().energies().elastic, before = heat.total_heat();
  ASSERT_EQ(t.run_until(0.3), "");
  const double lost = strained - t.world().energies().elastic;
  EXPECT_GT(lost, 0.9 * strained);
  // What the last step lost may warm in the next one.
  EXPECT_NEAR(heat.heat_from_strain(), lost, 1e-3 * strained);
  EXPECT_NEAR(heat.total_heat() - before, heat.heat_from_strain(), 1e-9 * before);
}

TEST(HeatEffect, WhatWasNotStrainedGivesNoHeatAsItMelts) {
  const auto world = held_block(false, false, "20");
  ParticleWorld& t = *world;
  auto& heat = dynamic_cast<HeatEffect&>(*t.body().find_effect("heat"));
  for (int i = 0; i < t.particles().size(); i += 2) heat.set_temperature(i, 320.0);
  ASSERT_EQ(t.run_until(0.1), "");
  EXPECT_NEAR(heat.heat_from_strain(), 0.0, 1e-12);
}

TEST(HeatEffect, RefusesWhatCannotBe) {
  ParticleWorld t(lattice_body({2, 2, 2}, 0.01), {}, 0.01);
  EXPECT_THROW(t.add_effect("heat", {{"melting_range", "0"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"melting_range", "1e-7"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"capacity", "0"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"capacity", "1e-4"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"latent_heat", "-1"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"temprature", "300"}}), InputError);
  EXPECT_EQ(t.body().find_effect("heat"), nullptr);
}

}  // namespace
}  // namespace pliant
