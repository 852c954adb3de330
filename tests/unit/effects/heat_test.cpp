#include "pliant/effects/heat.h"

#include <gtest/gtest.h>

#include "pliant/math/error.h"
#include "support/particle_bodies.h"

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

TEST(HeatEffect, RefusesWhatCannotBe) {
  ParticleWorld t(lattice_body({2, 2, 2}, 0.01), {}, 0.01);
  EXPECT_THROW(t.add_effect("heat", {{"melting_range", "0"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"capacity", "0"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"latent_heat", "-1"}}), InputError);
  EXPECT_THROW(t.add_effect("heat", {{"temprature", "300"}}), InputError);
  EXPECT_EQ(t.body().find_effect("heat"), nullptr);
}

}  // namespace
}  // namespace pliant
