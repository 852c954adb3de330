// What a device sums for the effects of particles, its kernels run by the CPU, against the effects.
#include <gtest/gtest.h>

#include "cuda/core/host_executor.h"
#include "cuda/models/viscoelastic/device_liquid.h"
#include "pliant/effects/particles/heat.h"
#include "support/worlds/liquid_sample.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

constexpr double kSize = 0.06;

/// Two warm liquids, one above the other, fall on a hot floor with all effects of particles.
std::unique_ptr<ParticleWorld> warm_blobs() {
  ViscoelasticModel::Material material = liquid_material();
  material.liquid.viscosity = 1.0;
  auto world =
      std::make_unique<ParticleWorld>(sampled_box({kSize, 0.05, 0.03}, 0.01), material, 1e-3);
  world->model().place(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.018)));
  material.liquid.density = 800.0;
  material.heat.conductivity = 20.0;
  material.heat.initial_temperature = 350.0;
  world->add(sampled_box({0.04, 0.04, 0.02}, 0.01), material, {0, 0, 0.045});
  Obstacle floor;
  floor.name = "floor";
  floor.shape = std::make_shared<Plane>();
  floor.pose_start = floor.pose_end = Eigen::Isometry3d::Identity();
  floor.temperature = 400.0;
  world->world().add_obstacle(floor);
  world->add_effect("gravity");
  world->add_effect("contact");
  world->add_effect("xsph", {{"rate", "100"}});
  world->add_effect("surface_tension", {{"tension", "1"}});
  world->add_effect("heat", {{"initial_temperature", "320"}, {"conductivity", "50"}});
  world->start();
  return world;
}

HeatEffect& heat_of(ParticleWorld& world) {
  return dynamic_cast<HeatEffect&>(*world.body().find_effect("heat"));
}

TEST(DeviceEffects, TakeThePathOfTheCpu) {
  const auto cpu = warm_blobs(), device = warm_blobs();
  device->model().system().liquid.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  const double heat = heat_of(*device).total_heat();
  const Eigen::VectorXd start = heat_of(*cpu).temperatures();
  ASSERT_EQ(cpu->run_until(0.04), "");
  ASSERT_EQ(device->run_until(0.04), "");
  ASSERT_TRUE(device->model().system().liquid.has_device());
  const auto off = (cpu->particles().x - device->particles().x).colwise().norm();
  EXPECT_LE(off.maxCoeff(), 1e-4 * kSize);
  const Eigen::VectorXd &exact = heat_of(*cpu).temperatures(),
                        &found = heat_of(*device).temperatures();
  const double warmed = (exact - start).cwiseAbs().maxCoeff();
  EXPECT_GT(warmed, 1.0);
  EXPECT_LE((found - exact).cwiseAbs().maxCoeff(), 1e-4 * warmed);
  const double rubbed = heat_of(*cpu).heat_from_motion();
  EXPECT_GT(rubbed, 1e-3);
  EXPECT_NEAR(heat_of(*device).heat_from_motion(), rubbed, 1e-4 * rubbed);
  // What one gives another takes, also there.
  const double kept = heat_of(*device).total_heat() - heat_of(*device).heat_from_outside() -
                      heat_of(*device).heat_from_motion();
  EXPECT_NEAR(kept, heat, 1e-12 * heat);
}

TEST(DeviceEffects, SumsAreThoseOfTheCpu) {
  const LiquidSample sample;
  Liquid liquid;
  sample.add_to(liquid);
  DeviceLiquid<HostExecutor> device;
  const LiquidState state = liquid.state(sample.particles, sample.beta);
  const Particles& p = sample.particles;
  const SphKernels kernels(liquid.support());
  const NeighborLists& lists = liquid.neighbors(p.x);
  Eigen::VectorXd squares(p.size()), drags(p.size());
  Eigen::Matrix3Xd cohesion(3, p.size()), mixing(3, p.size()), slope(3, p.size());
  lists.for_each_point([&](int rank, int i) {
    Eigen::Vector3d sums[3] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                               Eigen::Vector3d::Zero()};
    squares[i] = drags[i] = 0.0;
    lists.for_each_neighbor(rank, [&](int o) {
      const Eigen::Vector3d apart = p.x.col(i) - p.x.col(o);
      const double r2 = apart.squaredNorm(), volume = sample.volumes[o];
      const double beta = std::min(sample.beta[i], sample.beta[o]);
      const double mass = std::min(p.mass[i], p.mass[o]);
      sums[0] += beta * volume * volume * kernels.poly6_slope(r2) * apart;
      sums[1] -= beta * mass * volume * kernels.poly6(r2) * (p.v.col(i) - p.v.col(o));
      const double slip = (p.v.col(i) - p.v.col(o)).squaredNorm();
      squares[i] += beta * mass * volume * kernels.poly6(r2) * slip;
      const auto at = [&](int k) { return liquid.parts()[static_cast<std::size_t>(k)]; };
      const double weight = at(i) == at(o) ? std::max(sample.beta[i], sample.beta[o]) : 1.0;
      drags[i] += weight * volume * volume * slip * kernels.viscosity_laplacian(std::sqrt(r2)) *
                  0.5 * (liquid.material(i).viscosity + liquid.material(o).viscosity) /
                  kSphLaplacian;
      sums[2] += volume * kernels.poly6_slope(r2) * apart;
    });
    cohesion.col(i) = sums[0];
    mixing.col(i) = sums[1];
    slope.col(i) = sums[2];
  });
  Eigen::Matrix3Xd found;
  const auto expect = [&](const Eigen::Matrix3Xd& exact) {
    const double largest = exact.colwise().norm().maxCoeff();
    // Sums of 40 terms, each no larger than the largest sum.
    EXPECT_LE((found - exact).colwise().norm().maxCoeff(), 40 * 6e-8 * largest);
  };
  device.cohesion(state, found);
  expect(cohesion);
  device.mixing(state, found);
  expect(mixing);
  device.color_slope(state, found);
  expect(slope);
  Eigen::VectorXd sums;
  device.mixing_squares(state, sums);
  EXPECT_LE((sums - squares).cwiseAbs().maxCoeff(), 40 * 6e-8 * squares.maxCoeff());
  device.drag(state, sums);
  EXPECT_LE((sums - drags).cwiseAbs().maxCoeff(), 40 * 6e-8 * drags.maxCoeff());
}

}  // namespace
}  // namespace pliant
