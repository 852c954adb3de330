// Whole steps that stay on a device, their kernels run by the CPU, against a scene's.
#include "cuda/models/viscoelastic/resident_blend.h"

#include <gtest/gtest.h>

#include "cuda/core/host_executor.h"
#include "support/particle_bodies.h"

namespace pliant {
namespace {

constexpr double kStep = 1e-3, kSize = 0.07;

std::unique_ptr<ParticleWorld> make_blob(double beta) {
  ViscoelasticModel::Material material;
  material.beta = beta;
  material.liquid.viscosity = 1.0;
  auto world =
      std::make_unique<ParticleWorld>(sampled_box({kSize, kSize, 0.05}, 0.01), material, kStep);
  world->model().place(Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, 0.028)));
  world->model().set_velocity({0.3, 0.0, -0.5});
  return world;
}

class ResidentBlendOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Betas, ResidentBlendOf, testing::Values(0.0, 0.5, 1.0));

TEST_P(ResidentBlendOf, GoesTheWayOfTheScene) {
  const auto world = make_blob(GetParam());
  // Bodies that are all solid feel no walls of a liquid.
  const bool has_floor = GetParam() > 0.0;
  if (has_floor) {
    Obstacle floor;
    floor.name = "floor";
    floor.shape = std::make_shared<Plane>();
    floor.pose_start = floor.pose_end = Eigen::Isometry3d::Identity();
    world->world().add_obstacle(floor);
  }
  for (const char* effect : {"gravity", "contact"}) world->add_effect(effect);
  world->start("chebyshev", {{"iterations", "200"}, {"tolerance", "1e-9"}});
  ResidentBlend<HostExecutor>::Options options;
  options.dt = kStep;
  options.gravity = {0.0, 0.0, -9.81};
  options.iterations = 40;
  if (has_floor) options.walls = {{0.0, 0.0, 2.0, 0.0}};
  ResidentBlend<HostExecutor> blend(world->model().system(), options);
  Positions x, v;
  for (int s = 0; s < 40; ++s) {
    ASSERT_TRUE(world->world().step()) << world->world().failure();
    ASSERT_EQ(world->body().parts, 1);
    ASSERT_EQ(world->body().report.contacts, 0);
    blend.step();
  }
  blend.download(x, v);
  const Particles& exact = world->particles();
  EXPECT_LE((x - exact.x).colwise().norm().maxCoeff(), 1e-4 * kSize);
  // The floor made a difference.
  EXPECT_EQ((v.row(2).array() > -0.5).any(), has_floor);
}

TEST(ResidentBlend, RepeatsToTheBit) {
  Positions x[2], v[2];
  for (int k = 0; k < 2; ++k) {
    const auto world = make_blob(0.5);
    ResidentBlend<HostExecutor> blend(world->model().system(), {});
    for (int s = 0; s < 5; ++s) blend.step();
    blend.download(x[k], v[k]);
  }
  EXPECT_EQ(x[0], x[1]);
  EXPECT_EQ(v[0], v[1]);
}

TEST(ResidentBlend, RefusesWhatHasNoDeviceForm) {
  ViscoelasticModel::Material material;
  material.oriented = true;
  const ViscoelasticModel model(sampled_box({0.04, 0.04, 0.04}, 0.01), material);
  EXPECT_THROW(ResidentBlend<HostExecutor>(model.system(), {}), InputError);
  ResidentBlend<HostExecutor>::Options options;
  options.walls.assign(kMostWalls + 1, {0.0, 0.0, 1.0, 0.0});
  EXPECT_THROW(ResidentBlend<HostExecutor>(make_blob(0.5)->model().system(), options), InputError);
}

}  // namespace
}  // namespace pliant
