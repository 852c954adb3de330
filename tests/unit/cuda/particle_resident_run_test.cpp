// Resident runs of particles between solid and liquid, which stay on the device between steps: they
// are the steps that the host takes one by one.
#include <gtest/gtest.h>

#include "pliant/effects/attachment.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "support/solvers/device_solvers.h"
#include "support/worlds/particle_bodies.h"

namespace pliant::particle_resident_run_test {
namespace {

constexpr double kSize = 0.06;

struct Setting {
  double beta = 0.5;
  double dt = 1e-3;
  Eigen::Vector3d velocity = {0.3, 0.1, -0.5};
  int iterations = 20;
  std::vector<Obstacle> obstacles = {};
  std::vector<std::pair<std::string, ParameterText>> effects = {};
};

Obstacle standing(std::shared_ptr<const Shape> shape, const Eigen::Isometry3d& pose) {
  Obstacle obstacle;
  obstacle.name = "obstacle";
  obstacle.shape = std::move(shape);
  obstacle.pose_start = obstacle.pose_end = pose;
  return obstacle;
}

Eigen::Isometry3d at_height(double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(1.0, 2.0, z));
}

std::unique_ptr<ParticleWorld> make(const Setting& setting, int bodies = 1) {
  ViscoelasticModel::Material material;
  material.beta = setting.beta;
  material.liquid.viscosity = 1.0;
  const BodyGeometry box = sampled_box({kSize, kSize, 0.04}, 0.01);
  auto world = std::make_unique<ParticleWorld>(box, material, setting.dt);
  world->model().place(at_height(0.026));
  world->model().set_velocity(setting.velocity);
  if (bodies > 1) {
    material.liquid.density = 500.0;
    world->add(box, material, {1.0, 2.0, 0.07}, -setting.velocity);
  }
  for (const Obstacle& obstacle : setting.obstacles) world->world().add_obstacle(obstacle);
  for (const auto& [name, parameters] : setting.effects) world->add_effect(name, parameters);
  world->start("jacobi");
  world->body().solver = make_host_device_solver("chebyshev", {setting.iterations, 0.0, 0.0});
  world->world().system_changed();
  return world;
}

double distance(ParticleWorld& a, ParticleWorld& b) {
  return (a.particles().x - b.particles().x).colwise().norm().maxCoeff();
}

/// Takes so many steps one by one and in resident runs.
struct TwoWorlds {
  std::unique_ptr<ParticleWorld> single, resident;
};
TwoWorlds go(const Setting& setting, int steps, int bodies = 1) {
  TwoWorlds worlds{make(setting, bodies), make(setting, bodies)};
  EXPECT_TRUE(worlds.resident->world().step());
  EXPECT_GE(worlds.resident->world().resident_limit(steps), 2);
  EXPECT_TRUE(worlds.resident->world().advance(steps)) << worlds.resident->world().failure();
  for (int k = 0; k <= steps; ++k) {
    EXPECT_TRUE(worlds.single->world().step()) << worlds.single->world().failure();
  }
  EXPECT_EQ(worlds.resident->world().steps(), worlds.single->world().steps());
  return worlds;
}

struct ParticleGround {
  const char* name;
  double beta;
  std::vector<Obstacle> obstacles;
};

class ParticleResidentRunOn : public testing::TestWithParam<ParticleGround> {};
const Eigen::Isometry3d kLying =
    at_height(-0.05) * Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX());
const Eigen::Isometry3d kTilted =
    at_height(0.0) * Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 0).normalized());
INSTANTIATE_TEST_SUITE_P(
    Obstacles, ParticleResidentRunOn,
    testing::Values(
        ParticleGround{"SolidOnPlane", 0.0, {standing(std::make_shared<Plane>(), kTilted)}},
        ParticleGround{"BlendOnPlane", 0.5, {standing(std::make_shared<Plane>(), kTilted)}},
        ParticleGround{"LiquidInTank",
                       1.0,
                       {standing(std::make_shared<Plane>(), at_height(0.0)),
                        standing(std::make_shared<Box>(Eigen::Vector3d(0.1, 1, 1)),
                                 Eigen::Isometry3d(Eigen::Translation3d(1.085, 2, 0)))}},
        ParticleGround{
            "BlendOnSphere", 0.5, {standing(std::make_shared<Sphere>(0.1), at_height(-0.1))}},
        ParticleGround{
            "LiquidOnCapsule", 1.0, {standing(std::make_shared<Capsule>(0.05, 0.1), kLying)}},
        ParticleGround{
            "SolidOnCylinder", 0.0, {standing(std::make_shared<Cylinder>(0.05, 0.2), kLying)}}),
    [](const auto& info) { return std::string(info.param.name); });

void expect_steps_one_by_one(double beta, const std::vector<Obstacle>& obstacles) {
  Setting setting;
  setting.beta = beta;
  setting.obstacles = obstacles;
  setting.effects = {{"gravity", {}},
                     {"surface_tension", {}},
                     {"contact", {}},
                     {"friction", {{"coefficient", "0.4"}}},
                     {"xsph", {{"rate", "100"}}},
                     {"damping", {{"rate", "1"}}}};
  const TwoWorlds worlds = go(setting, 40);
  const Particles &exact = worlds.single->particles(), &found = worlds.resident->particles();
  EXPECT_LE(distance(*worlds.single, *worlds.resident), 1e-5 * kSize);
  EXPECT_LE((found.v - exact.v).norm(), 1e-4 * exact.v.norm());
  EXPECT_LE((found.v_start - exact.v_start).norm(), 1e-4 * exact.v.norm());
  EXPECT_LE((found.x_start - exact.x_start).norm(), 1e-5 * kSize * std::sqrt(found.size()));
  const auto &forces = worlds.resident->world().reactions(),
             &single = worlds.single->world().reactions();
  for (std::size_t o = 0; o < forces.size(); ++o) {
    const double size = single[0].force.norm();
    EXPECT_GT(size, 0.0) << "the obstacle made a difference";
    EXPECT_LE((forces[o].force - single[o].force).norm(), 0.01 * size) << o;
    EXPECT_LE((forces[o].torque - single[o].torque).norm(), 0.01 * size * kSize) << o;
  }
  EXPECT_EQ(worlds.resident->body().report.step, worlds.single->body().report.step);
  EXPECT_EQ(worlds.resident->body().report.time, worlds.single->body().report.time);
  EXPECT_EQ(worlds.resident->body().report.backend, "cuda");
}

TEST_P(ParticleResidentRunOn, IsTheStepsOneByOne) {
  expect_steps_one_by_one(GetParam().beta, GetParam().obstacles);
}

TEST(ParticleResidentRun, AMeshIsAWallAndAnObstacle) {
  const auto ball = std::make_shared<MeshShape>(Sphere(0.1).surface());
  expect_steps_one_by_one(0.5, {standing(ball, at_height(-0.1))});
}

TEST(ParticleResidentRun, StepsInSubstepsAreTakenSo) {
  Setting setting;
  setting.dt = 4e-3;
  setting.obstacles = {standing(std::make_shared<Plane>(), at_height(0.0))};
  setting.effects = {{"gravity", {}}, {"contact", {}}, {"damping", {{"rate", "1"}}}};
  const TwoWorlds worlds = go(setting, 10);
  ASSERT_GT(worlds.single->body().substeps, 1);
  EXPECT_EQ(worlds.resident->body().substeps, worlds.single->body().substeps);
  EXPECT_LE(distance(*worlds.single, *worlds.resident), 1e-5 * kSize);
  const Eigen::Vector3d force = worlds.single->world().reactions()[0].force;
  EXPECT_LE((worlds.resident->world().reactions()[0].force - force).norm(), 0.01 * force.norm());
}

TEST(ParticleResidentRun, EndsWhereAStepNeedsOtherSubsteps) {
  Setting setting;
  setting.beta = 1.0;
  setting.effects = {{"gravity", {{"acceleration", "[0, 0, -200]"}}}};
  setting.velocity = {0, 0, 0};
  const auto resident = make(setting), single = make(setting);
  ASSERT_TRUE(resident->world().step());
  const double sound = resident->model().system().liquid.material(0).sound_speed;
  // Of the fastest, when a step without substeps is stable no more.
  const double most = 0.4 * resident->model().support() / setting.dt - sound;
  const int expected = static_cast<int>(std::ceil(most / (200.0 * setting.dt))) - 1;
  ASSERT_EQ(resident->world().resident_limit(20), 20);
  resident->world().begin_resident_run(20);
  const int taken = resident->world().finish_resident_run();
  EXPECT_NEAR(taken, expected, 1);
  EXPECT_EQ(resident->world().steps(), 1u + static_cast<unsigned>(taken));
  EXPECT_EQ(resident->world().resident_limit(20), 0) << "the solver knows other steps";
  ASSERT_TRUE(resident->world().step());
  EXPECT_GT(resident->body().substeps, 1);
  ASSERT_TRUE(resident->world().advance(10));
  while (single->world().steps() < resident->world().steps()) ASSERT_TRUE(single->world().step());
  EXPECT_EQ(resident->body().substeps, single->body().substeps);
  EXPECT_LE(distance(*single, *resident), 1e-5 * kSize);
}

TEST(ParticleResidentRun, BodiesThatTouchKeepTheirMomenta) {
  // Two iterations leave much unbalanced.
  Setting setting;
  setting.beta = 0.3;
  setting.iterations = 2;
  setting.effects = {{"gravity", {}}};
  const TwoWorlds worlds = go(setting, 20, 2);
  EXPECT_LE(distance(*worlds.single, *worlds.resident), 1e-5 * kSize);
  const Particles& p = worlds.resident->particles();
  const double fallen = 9.81 * 21 * setting.dt, mass = p.mass.sum();
  const double before =
      setting.velocity[2] * (p.mass.head(p.size() / 2).sum() - p.mass.tail(p.size() / 2).sum());
  EXPECT_NEAR(p.momentum()[2], before - mass * fallen, 1e-6 * mass);
}

TEST(ParticleResidentRun, ClustersFollowBetaBetweenResidentRuns) {
  Setting setting;
  setting.beta = 0.0;
  setting.effects = {{"gravity", {}}};
  setting.dt = 2e-3;
  const auto resident = make(setting), single = make(setting);
  for (ParticleWorld* world : {resident.get(), single.get()}) {
    ASSERT_TRUE(world->world().step());
    for (int i = 0; i < 40; ++i) world->model().set_beta(i, 0.6);
  }
  ASSERT_TRUE(resident->world().step());
  ASSERT_TRUE(single->world().step());
  // Clusters follow with the tenth step; two were taken.
  const int limit = resident->world().resident_limit(50);
  EXPECT_GE(limit, 6);
  EXPECT_LE(limit, 7);
  ASSERT_TRUE(resident->world().advance(20));
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(single->world().step());
  EXPECT_EQ(resident->model().system().solid().weights(),
            single->model().system().solid().weights());
  EXPECT_DOUBLE_EQ(resident->model().system().solid().weights()[0], 0.4);
  EXPECT_EQ(resident->model().system().unfollowed, single->model().system().unfollowed);
  EXPECT_LE(distance(*single, *resident), 1e-5 * kSize);
}

TEST(ParticleResidentRun, AttachmentsHoldUntilTheyEnd) {
  Setting setting;
  setting.beta = 0.0;
  setting.velocity = {0, 0, 0};
  setting.effects = {{"gravity", {}}};
  const auto resident = make(setting), single = make(setting);
  AttachmentRequest request;
  request.name = "hook";
  request.region.kind = Region::Kind::kSphere;
  request.region.center = {1.0, 2.0, 0.05};
  request.region.radius = 0.04;
  request.count = resident->particles().size();
  request.stiffness = 500.0;
  request.until = 0.03;
  for (ParticleWorld* world : {resident.get(), single.get()}) {
    attachments_of(world->body(), world->world().obstacles()).add(request);
    ASSERT_TRUE(world->world().step());
  }
  const int limit = resident->world().resident_limit(100);
  EXPECT_GE(limit, 28);
  EXPECT_LE(limit, 29);
  ASSERT_TRUE(resident->world().advance(25));
  for (int k = 0; k < 25; ++k) ASSERT_TRUE(single->world().step());
  EXPECT_LE(distance(*single, *resident), 1e-5 * kSize);
  const double held = single->particles().v.row(2).mean();
  EXPECT_GT(held, -0.8 * 9.81 * single->world().time()) << "it holds";
  ASSERT_TRUE(resident->world().advance(20));
  for (int k = 0; k < 20; ++k) ASSERT_TRUE(single->world().step());
  EXPECT_LE(distance(*single, *resident), 1e-5 * kSize);
}

TEST(ParticleResidentRun, RepeatsToTheBit) {
  Setting setting;
  setting.obstacles = {standing(std::make_shared<Sphere>(0.1), at_height(-0.1))};
  setting.effects = {{"gravity", {}}, {"contact", {}}, {"xsph", {}}};
  const auto first = make(setting), second = make(setting);
  ASSERT_TRUE(first->world().advance(12));
  ASSERT_TRUE(second->world().advance(12));
  EXPECT_EQ(first->particles().x, second->particles().x);
  EXPECT_EQ(first->particles().v, second->particles().v);
}

TEST(ParticleResidentRun, WhatLeavesAllBoundsIsUndone) {
  Setting setting;
  setting.effects = {{"gravity", {{"acceleration", "[0, 0, -1000]"}}}};
  const auto world = make(setting);
  ASSERT_TRUE(world->world().step());
  world->world().finite_check().max_speed = 3.0;
  ASSERT_FALSE(world->world().advance(20));
  EXPECT_NE(world->world().failure().find("m/s"), std::string::npos) << world->world().failure();
  EXPECT_LE(world->particles().v.colwise().norm().maxCoeff(), 3.0);
  EXPECT_GE(world->world().steps(), 2u);
}

struct Refusal {
  const char* name;
  Setting setting;
};

class NoParticleResidentRun : public testing::TestWithParam<Refusal> {};
INSTANTIATE_TEST_SUITE_P(
    Scenes, NoParticleResidentRun,
    testing::Values(Refusal{"Plasticity", {0.5, 1e-3, {0, 0, 0}, 5, {}, {{"plasticity", {}}}}},
                    Refusal{"Heat", {0.5, 1e-3, {0, 0, 0}, 5, {}, {{"heat", {}}}}},
                    Refusal{"NineObstacles",
                            {0.5,
                             1e-3,
                             {0, 0, 0},
                             5,
                             std::vector<Obstacle>(9, standing(std::make_shared<Sphere>(0.1),
                                                               at_height(-0.2))),
                             {{"contact", {}}}}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(NoParticleResidentRun, StepsOneByOneInstead) {
  const auto world = make(GetParam().setting);
  ASSERT_TRUE(world->world().step());
  EXPECT_EQ(world->world().resident_limit(10), 0);
  ASSERT_TRUE(world->world().advance(2)) << world->world().failure();
  EXPECT_EQ(world->world().steps(), 3u);
}

}  // namespace
}  // namespace pliant::particle_resident_run_test
