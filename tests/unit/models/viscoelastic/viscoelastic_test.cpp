#include "pliant/models/viscoelastic/viscoelastic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pliant/math/error.h"
#include "pliant/models/registry.h"
#include "support/expect_refusal.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

std::unique_ptr<Model> made(const ParameterText& text) {
  const auto& entry = model_registry().find("viscoelastic");
  return entry.make(parse_parameters(entry.parameters, text, "material"),
                    lattice_body({4, 4, 4}, 0.01));
}

double beta_of(const ParameterText& text) {
  return dynamic_cast<ViscoelasticModel&>(*made(text)).beta().maxCoeff();
}

TEST(ViscoelasticModel, StatesArePresets) {
  EXPECT_EQ(beta_of({{"state", "rigid"}}), 0.0);
  EXPECT_EQ(beta_of({{"state", "elastic"}}), 0.0);
  EXPECT_EQ(beta_of({{"state", "viscoelastic"}}), 0.5);
  EXPECT_EQ(beta_of({{"state", "liquid"}}), 1.0);
  EXPECT_EQ(beta_of({{"state", "elastic"}, {"beta", "0.25"}}), 0.25);
  const auto clusters = [](const ParameterText& text) {
    return dynamic_cast<ViscoelasticModel&>(*made(text)).system().solid().clusters();
  };
  EXPECT_EQ(clusters({{"state", "rigid"}}), 1);
  EXPECT_EQ(clusters({{"state", "elastic"}, {"cluster_fraction", "1"}}), 64);
  EXPECT_EQ(clusters({{"state", "liquid"}}), 0);
}

TEST(ViscoelasticModel, RefusesWhatCannotBe) {
  EXPECT_THROW(made({{"state", "gaseous"}}), InputError);
  EXPECT_THROW(made({{"young", "0"}}), InputError);
  EXPECT_THROW(made({{"alpha", "1"}}), InputError);
  EXPECT_THROW(made({{"beta", "1.1"}}), InputError);
  EXPECT_THROW(made({{"cluster_fraction", "0"}}), InputError);
  EXPECT_THROW(made({{"viscosity", "-1"}}), InputError);
  EXPECT_THROW(made({{"sound_speed", "0"}}), InputError);
  EXPECT_THROW(made({{"yong", "1"}}), InputError);
  expect_refusal([&] { made({{"melting_point", "0"}}); }, {"melting_point", "> 0", "negative"});
  expect_refusal(
      [&] {
        made({{"melting_range", "0"}});
      },
      {"melting_range", ">= 1e-06", "negative"});
  for (const char* capacity : {"0", "1e-4"}) {
    expect_refusal([&] { made({{"capacity", capacity}}); }, {"capacity", ">= 0.001", "negative"});
  }
  EXPECT_THROW(made({{"latent_heat", "1e10"}}), InputError);
  EXPECT_THROW(made({{"solid_beta", "1.5"}}), InputError);
  EXPECT_THROW(made({{"conductivity", "-2"}}), InputError);
  EXPECT_NO_THROW(made({{"conductivity", "0"}, {"latent_heat", "0"}, {"capacity", "-1"}}));
  EXPECT_THROW(ViscoelasticModel(BodyGeometry(), {}), InputError) << "no particles";
}

TEST(ViscoelasticModel, ClustersCoverEveryParticleWhateverTheirFraction) {
  for (double fraction : {0.001, 0.1, 0.3, 1.0}) {
    ViscoelasticModel::Material material;
    material.solid.cluster_fraction = fraction;
    const ViscoelasticModel model(sampled_box({0.1, 0.08, 0.06}, 0.01), material);
    const Eigen::VectorXd counts = model.system().solid().counts();
    EXPECT_GE(counts.minCoeff(), 1.0) << fraction;
    if (fraction >= 0.1) {
      EXPECT_LE(model.system().solid().clusters(), fraction * counts.size() + 1);
    }
  }
}

TEST(ViscoelasticModel, AUniformStrainStoresTheModulussEnergyWhateverTheClusters) {
  const double young = 2e4;
  for (double fraction : {0.1, 0.3, 1.0}) {
    ViscoelasticModel::Material material;
    material.solid.young = young;
    material.solid.cluster_fraction = fraction;
    ViscoelasticModel model(sampled_box({0.12, 0.12, 0.12}, 0.01), material);
    const double strain = 1e-3;
    Positions& x = model.particles().x;
    double energy = 0.0;
    // Of the three directions' mean, since clusters at the surface are flat.
    for (int axis = 0; axis < 3; ++axis) {
      x.row(axis) *= 1.0 + strain;
      energy += model.system().elastic_energy() / 3.0;
      x.row(axis) /= 1.0 + strain;
    }
    const double exact = 0.5 * young * strain * strain * 0.12 * 0.12 * 0.12;
    EXPECT_NEAR(energy, exact, 0.01 * exact) << fraction;
  }
}

TEST(LiquidWalls, TheirPushIsTheSlopeOfAnEnergy) {
  // One particle in the corner of two walls, so near that they compress it. With p = c² ρ (ψ − 1)
  // its energy is V c² ρ ∫ (ψ − 1)/ψ² dψ = V c² ρ (ln ψ + 1/ψ).
  const double volume = 1e-6;
  const LiquidMaterial material;
  Liquid liquid;
  liquid.add_part(Eigen::VectorXd::Constant(1, volume), material);
  const double support = liquid.support();
  Obstacle floor, side;
  floor.shape = side.shape = std::make_shared<Plane>();  // fills z < 0
  side.pose_start = side.pose_end = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitY());
  const Eigen::VectorXd beta = Eigen::VectorXd::Ones(1);
  const Eigen::Vector3d place(0.2 * support, 0.0, 0.05 * support);
  const auto at = [&](const Eigen::Vector3d& x, Forces& f) {
    Particles particles(x, Eigen::VectorXd::Constant(1, material.density * volume));
    LiquidWalls walls;
    walls.find(particles.x, {floor, side}, support, 1e-3);
    StepReport report;
    f = Forces::Zero(3, 1);
    liquid.neighbors(particles.x);
    liquid.add_forces(particles, beta, &walls, f, report);
    const double psi = liquid.last_filling()[0];
    EXPECT_GT(psi, 1.0);
    return volume * material.sound_speed * material.sound_speed * material.density *
           (std::log(psi) + 1.0 / psi);
  };
  Forces f, unused;
  at(place, f);
  const double step = 1e-5 * support;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
    const double slope = (at(place + offset, unused) - at(place - offset, unused)) / (2.0 * step);
    EXPECT_NEAR(f(axis, 0), -slope, 1e-6 * f.norm()) << axis;
  }
}

TEST(ViscoelasticModel, AStepThatNeedsTooManySubstepsIsRefusedWithTheLargest) {
  ViscoelasticModel::Material material = liquid_material();
  material.max_substeps = 2;
  ParticleWorld t(lattice_body({4, 4, 4}, 0.01), material, 0.02);
  t.start();
  const Positions before = t.particles().x;
  EXPECT_FALSE(t.world().step());
  EXPECT_NE(t.world().failure().find("max_substeps"), std::string::npos) << t.world().failure();
  EXPECT_NE(t.world().failure().find("time step of"), std::string::npos);
  EXPECT_TRUE(t.particles().x == before);
  EXPECT_EQ(t.world().steps(), 0u);
}

TEST(ViscoelasticModel, BodiesJoinAndKeepTheirColors) {
  ParticleWorld t(lattice_body({3, 3, 3}, 0.01), liquid_material(), 0.01);
  t.model().color = {1.0f, 0.0f, 0.0f};
  ViscoelasticModel other(lattice_body({2, 2, 2}, 0.01), {});
  other.color = {0.0f, 1.0f, 0.0f};
  ASSERT_TRUE(t.model().join(other));
  EXPECT_EQ(t.particles().size(), 35);
  const Eigen::Matrix3Xf colors = t.model().particle_colors();
  EXPECT_EQ(colors(0, 0), 1.0f);
  EXPECT_EQ(colors(1, 34), 1.0f);
  ViscoelasticModel::Material turning;
  turning.oriented = true;
  ViscoelasticModel turned(lattice_body({2, 2, 2}, 0.01), turning);
  EXPECT_THROW(t.model().join(turned), InputError);
}

TEST(ViscoelasticModel, ShowsFields) {
  ParticleWorld t(lattice_body({6, 6, 6}, 0.01), liquid_material(), 0.01);
  t.add_effect("heat", {{"initial_temperature", "400"}});
  const auto fields = t.model().point_fields();
  for (const char* name : {"beta", "density", "clusters", "temperature"}) {
    ASSERT_EQ(fields.count(name), 1u) << name;
    EXPECT_EQ(fields.at(name).size(), 216) << name;
  }
  EXPECT_EQ(fields.at("temperature")[0], 400.0);
  EXPECT_NEAR(fields.at("density").maxCoeff(), 1000.0, 30.0);
}

}  // namespace
}  // namespace pliant
