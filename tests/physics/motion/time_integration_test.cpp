// What integrations of second order promise: order, momentum, energy, and contact all the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "pliant/effects/attachment.h"
#include "pliant/models/viscoelastic/viscoelastic.h"
#include "pliant/solvers/time/time_integrations.h"
#include "support/measures.h"
#include "support/worlds/body_pairs.h"
#include "support/worlds/particle_bodies.h"
#include "support/worlds/patch_worlds.h"
#include "support/worlds/tent.h"
#include "support/worlds/worlds.h"

namespace pliant::time_integration_test {
namespace {

const ParameterText kConverged = {{"iterations", "30"}, {"tolerance", "1e-11"}};

void integrate_by(World& world, const std::string& name) {
  world.set_time_integration(body_of(world), time_integrations(), name);
}

std::string_view first_order(World& world) { return body_of(world).report.first_order; }

PatchScene bar(double dt) {
  PatchScene scene;
  scene.kind = "block";
  scene.size = {{"size", "[0.2, 0.05, 0.05]"}, {"cells", "[6, 2, 2]"}};
  scene.options = {{"contact_spacing", "0.1"}};
  scene.material = {{"young", "1e5"}, {"poisson", "0.3"}, {"density", "500"}};
  scene.solver = "newton";
  scene.solver_parameters = kConverged;
  scene.time_step = dt;
  return scene;
}

void spin(Particles& p, double speed) {
  for (int i = 0; i < p.size(); ++i) {
    p.v.col(i) = speed * Eigen::Vector3d::UnitZ().cross(Eigen::Vector3d(p.x.col(i)));
  }
}

class SecondOrder : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Both, SecondOrder, testing::Values("bdf2", "midpoint"), test_name_of);

struct Kept {
  double angular = 0.0, energy = 0.0;  // largest relative changes
  int first_order = 0;                 // steps
};

Kept spin_for(double seconds, const std::string& integration) {
  auto world = make_world(bar(5e-3));
  integrate_by(*world, integration);
  Particles& p = particles_of(*world);
  spin(p, 8.0);
  const double angular = p.angular_momentum().z(), energy = world->energies().total();
  Kept kept;
  while (world->time() < seconds - 1e-9) {
    EXPECT_TRUE(world->step());
    kept.angular = std::max(kept.angular, std::abs(p.angular_momentum().z() / angular - 1.0));
    kept.energy = std::max(kept.energy, std::abs(world->energies().total() / energy - 1.0));
    if (!first_order(*world).empty()) ++kept.first_order;
  }
  return kept;
}

TEST_P(SecondOrder, AFreeSpinKeepsAngularMomentumAndEnergy) {
  const Kept kept = spin_for(2.0, GetParam());
  EXPECT_LE(kept.angular, 1e-6);
  EXPECT_LE(kept.energy, 0.01);
  EXPECT_LE(kept.first_order, 1) << "the start of bdf2";
}

TEST(FirstOrder, AFreeSpinLosesMuchOfBoth) {
  const Kept kept = spin_for(0.5, "implicit_euler");
  EXPECT_GE(kept.angular, 0.05);
  EXPECT_GE(kept.energy, 0.1);
  EXPECT_EQ(kept.first_order, 0);
}

/// Where a scene's body is at the end of a time, by steps of `dt`.
using Motion = std::function<Positions(const std::string& integration, double dt)>;

Positions end_of(World& world, const std::string& integration, double seconds) {
  integrate_by(world, integration);
  while (world.time() < seconds - 1e-9) EXPECT_TRUE(world.step());
  return particles_of(world).x;
}

/// The order that the last halving of the step shows, against half of the smallest step.
double order_of(const Motion& run, const std::string& integration, double dt) {
  const Positions coarse = run(integration, dt), middle = run(integration, 0.5 * dt),
                  fine = run(integration, 0.25 * dt);
  return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

Positions swinging_cloth(const std::string& integration, double dt) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 5, 5};
  scene.material = {
      {"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "5"}, {"bending", "1e-4"}};
  scene.fixed = row_of(scene.grid, 4);
  scene.pose = at(0, 0, 0) * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
  scene.effects = {{"gravity", {}}};
  scene.solver = "newton";
  scene.solver_parameters = kConverged;
  scene.time_step = dt;
  auto world = make_world(scene);
  return end_of(*world, integration, 0.08);
}

PatchScene held_bar(double dt) {
  PatchScene scene = bar(dt);
  scene.material["young"] = "5e3";
  scene.effects = {{"gravity", {}}};
  return scene;
}

Positions bar_after(double seconds, const std::string& integration, double dt) {
  auto world = make_world(held_bar(dt));
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) {
    if (p.x(0, i) < -0.099) p.fix(i);
  }
  world->system_changed();
  return end_of(*world, integration, seconds);
}

Positions swinging_bar(const std::string& integration, double dt) {
  return bar_after(0.08, integration, dt);
}

Positions swinging_particles(const std::string& integration, double dt) {
  ViscoelasticModel::Material material;
  material.beta = 0.0;
  ParticleWorld scene(sampled_box(Eigen::Vector3d(0.2, 0.06, 0.06), 0.03), material, dt);
  scene.add_effect("gravity");
  Particles& p = scene.particles();
  for (int i = 0; i < p.size(); ++i) {
    if (p.x(0, i) < -0.07) p.fix(i);
  }
  scene.start("direct", {{"iterations", "300"}, {"tolerance", "1e-11"}});
  return end_of(scene.world(), integration, 0.04);
}

TEST_P(SecondOrder, ErrorsFallWithTheSquareOfTheStep) {
  EXPECT_GE(order_of(swinging_cloth, GetParam(), 2e-3), 1.8);
  EXPECT_GE(order_of(swinging_bar, GetParam(), 2e-3), 1.8);
  EXPECT_GE(order_of(swinging_particles, GetParam(), 2e-3), 1.8);
}

TEST(FirstOrder, ErrorsFallWithTheStep) {
  for (const Motion& run : {Motion(swinging_cloth), Motion(swinging_bar)}) {
    const double order = order_of(run, "implicit_euler", 1e-3);
    EXPECT_GE(order, 0.8);
    EXPECT_LE(order, 1.3);
  }
}

TEST_P(SecondOrder, ASwingTakesLessThanAQuarterOfTheSteps) {
  const Positions exact = bar_after(0.24, "midpoint", 1e-3);
  const auto error = [&](const std::string& integration, double dt) {
    return (bar_after(0.24, integration, dt) - exact).norm();
  };
  EXPECT_LE(error(GetParam(), 8e-3), 0.7 * error("implicit_euler", 2e-3));
}

/// A bar of few tetrahedra whose steps cost little.
PatchScene small_bar(double dt) {
  PatchScene scene = bar(dt);
  scene.size = {{"size", "[0.1, 0.05, 0.05]"}, {"cells", "[1, 1, 1]"}};
  return scene;
}

TEST_P(SecondOrder, TenThousandStepsOfFlightAndSpinKeepMomentumAndEnergy) {
  auto world = make_world(small_bar(2e-3));
  integrate_by(*world, GetParam());
  Particles& p = particles_of(*world);
  spin(p, 8.0);
  p.v.colwise() += Eigen::Vector3d(0.3, -0.2, 0.1);
  const Eigen::Vector3d momentum = p.momentum(), angular = p.angular_momentum();
  const double energy = world->energies().total();
  for (int k = 0; k < 10000; ++k) ASSERT_TRUE(world->step());
  EXPECT_LE((p.momentum() - momentum).norm(), 1e-9 * momentum.norm());
  EXPECT_LE((p.angular_momentum() - angular).norm(), 1e-5 * angular.norm());
  EXPECT_NEAR(world->energies().total() / energy, 1.0, 0.01);
}

TEST_P(SecondOrder, TenThousandStepsOfASwingKeepEnergyAsTheyPromise) {
  PatchScene scene = small_bar(2e-3);
  scene.effects = {{"gravity", {}}};
  auto world = make_world(scene);
  integrate_by(*world, GetParam());
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) {
    if (p.x(0, i) < -0.049) p.fix(i);
  }
  world->system_changed();
  const double start = world->energies().total();
  double most = -1e9, swing = 0.0, late = 0.0;
  for (int k = 0; k < 10000; ++k) {
    ASSERT_TRUE(world->step());
    const Energies energies = world->energies();
    most = std::max(most, energies.total() - start);
    (k < 1000 ? swing : late) = std::max(k < 1000 ? swing : late, energies.kinetic);
  }
  EXPECT_LE(most, 0.01 * swing) << "none comes from nowhere";
  if (GetParam() == "midpoint") EXPECT_GE(late, 0.9 * swing) << "it swings on";
}

TEST(Midpoint, StepsThatGainEnergyAreOfFirstOrder) {
  // So large steps that the rule throws the bar from side to side.
  PatchScene scene = held_bar(0.04);
  scene.size["size"] = "[0.4, 0.04, 0.04]";
  scene.size["cells"] = "[10, 1, 1]";
  scene.material["young"] = "2e5";
  auto world = make_world(scene);
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) {
    if (p.x(0, i) < -0.199) p.fix(i);
  }
  world->system_changed();
  integrate_by(*world, "midpoint");
  const double start = world->energies().total();
  int held = 0;
  double most = 0.0, swing = 0.0;
  while (world->time() < 4.0 - 1e-9) {
    ASSERT_TRUE(world->step());
    held += first_order(*world) == "energy" ? 1 : 0;
    most = std::max(most, world->energies().total() - start);
    swing = std::max(swing, world->energies().elastic + world->energies().kinetic);
  }
  EXPECT_GT(held, 0) << "the scene tests nothing";
  EXPECT_LE(most, 0.1 * swing);
}

class EveryImplicitSolver : public EverySolver {};
PLIANT_FOR_IMPLICIT_SOLVERS(EveryImplicitSolver);

TEST_P(EveryImplicitSolver, TakesTheSameStepsOfSecondOrder) {
  for (const std::string integration : {"bdf2", "midpoint"}) {
    const auto run = [&](const std::string& name) {
      ClothScene scene;
      scene.grid = {0.3, 0.3, 5, 5};
      scene.material = soft_material();
      scene.fixed = row_of(scene.grid, 4);
      scene.effects = {{"gravity", {}}};
      scene.solver = name;
      scene.solver_parameters = converged(name);
      scene.time_step = 1e-3;
      auto world = make_world(scene);
      const Positions start = particles_of(*world).x;
      return Positions(end_of(*world, integration, 0.02) - start);
    };
    const Positions expected = run("newton"), found = run(solver());
    // xpbd leaves out how springs turn.
    const double bound = solver() == "xpbd" ? 1e-4 : 1e-8;
    EXPECT_LE((found - expected).norm(), bound * expected.norm()) << integration;
  }
}

PatchScene block_on_ground(double dt, double height) {
  PatchScene scene = falling_block("newton", kConverged);
  scene.pose = at(0, 0, height);
  scene.material["young"] = "1e5";
  scene.effects = {{"gravity", {}}, {"contact", {{"thickness", "1e-4"}}}, {"friction", {}}};
  scene.time_step = dt;
  return scene;
}

TEST_P(SecondOrder, WhatFallsIsCaughtAtFirstOrderAndRests) {
  auto world = make_world(block_on_ground(5e-3, 0.1));
  integrate_by(*world, GetParam());
  Particles& p = particles_of(*world);
  bool hit = false;
  double lowest = 1.0, most = -1e9, imbalance = 0.0;
  const double weight = 9.81 * p.mass.sum();
  const double start = world->energies().total();
  while (world->time() < 1.0) {
    ASSERT_TRUE(world->step());
    hit = hit || !first_order(*world).empty();
    lowest = std::min(lowest, p.x.row(2).minCoeff());
    most = std::max(most, world->energies().total() - start);
    imbalance = std::max(imbalance, body_of(*world).report.impulse_imbalance.value_or(0.0));
  }
  EXPECT_TRUE(hit) << "the impact";
  EXPECT_GE(lowest, 0.0) << "nothing passes";
  EXPECT_LE(most, 0.01 * std::abs(start)) << "no energy comes from nowhere";
  EXPECT_LE(imbalance, 1e-3);
  EXPECT_LE(p.v.colwise().norm().maxCoeff(), 1e-3) << "it rests";
  EXPECT_NEAR(world->reactions()[0].force.z(), -weight, 0.01 * weight);
}

/// Where a block on the ground is that sticks to it and shears to and fro.
Positions sticking_block(const std::string& integration, double dt) {
  PatchScene scene = block_on_ground(dt, 0.0501);
  scene.material["young"] = "1e4";
  scene.effects.back().second = {{"coefficient", "1"}};
  auto world = make_world(scene);
  Particles& p = particles_of(*world);
  for (int i = 0; i < p.size(); ++i) p.v.col(i) << 0.3 * p.x(2, i), 0, 0;
  return end_of(*world, integration, 0.08);
}

TEST_P(SecondOrder, IsOfSecondOrderInStickingContactToo) {
  EXPECT_GE(order_of(sticking_block, GetParam(), 2e-3), 1.6);
}

/// Swings the only obstacle to and fro across the bar, without a jump of its velocity.
class Swinging final : public ObstacleDriver {
 public:
  explicit Swinging(const Eigen::Isometry3d& start) : start_(start) {}
  void drive(double time, std::vector<Obstacle>& obstacles) override {
    const double displacement = 0.01 * (1.0 - std::cos(40.0 * time));
    obstacles[0].pose_end = Eigen::Translation3d(0.0, displacement, 0.0) * start_;
  }

 private:
  Eigen::Isometry3d start_;
};

/// Where a bar is whose end a hand swings to and fro.
Positions led_bar(const std::string& integration, double dt) {
  PatchScene scene = bar(dt);
  scene.material["young"] = "2e4";
  const Eigen::Isometry3d hand = at(0, 0, 1);
  scene.obstacles = {obstacle(Sphere(0.01), hand)};
  auto world = make_world(scene);
  AttachmentRequest request;
  request.name = "grip";
  request.region.kind = Region::Kind::kBox;
  request.region.box.extend(Eigen::Vector3d(-1, -1, -1)).extend(Eigen::Vector3d(-0.099, 1, 1));
  request.count = particles_of(*world).size();
  request.obstacle = 0;
  request.stiffness = 1e4;
  attachments_of(body_of(*world), world->obstacles()).attach_now(request, dt);
  world->add_driver(std::make_unique<Swinging>(hand));
  return end_of(*world, integration, 0.08);
}

TEST_P(SecondOrder, IsOfSecondOrderWhereAHandLeads) {
  EXPECT_GE(order_of(led_bar, GetParam(), 2e-3), 1.7);
}

TEST_P(SecondOrder, BodiesThatCollideKeepMomentumAndDoNotPass) {
  auto world = world_of(scene_text({slab("a", "patch", 0.14, "velocity: [0.1, 0, -1]"),
                                    slab("b", "patch", 0.05, "velocity: [0, 0, 0.1]")},
                                   "  body_contact: {}\n",
                                   "solver: {name: newton, iterations: 20, tolerance: 1.0e-10}\n"
                                   "time_integration: " +
                                       GetParam() + "\n"));
  const auto sum = [&](auto of) {
    return Eigen::Vector3d(of(world->bodies()[0].particles()) + of(world->bodies()[1].particles()));
  };
  const auto momentum = [&] { return sum([](const Particles& p) { return p.momentum(); }); };
  const auto angular = [&] { return sum([](const Particles& p) { return p.angular_momentum(); }); };
  const Eigen::Vector3d momentum_before = momentum(), angular_before = angular();
  const double energy = world->energies().total(), size = momentum_before.norm();
  bool hit = false;
  while (world->time() < 0.3) {
    ASSERT_TRUE(world->step()) << world->failure();
    const StepReport& report = world->bodies().front().report;
    hit = hit || (report.first_order != "" && report.first_order != "start");
    ASSERT_LE(world->energies().total(), 1.01 * energy);
    const double gap = world->bodies()[0].particles().x.row(2).minCoeff() -
                       world->bodies()[1].particles().x.row(2).maxCoeff();
    ASSERT_GE(gap, -0.02) << "they do not pass; while they turn, corners stand lower";
  }
  EXPECT_TRUE(hit);
  EXPECT_GT(world->bodies()[0].particles().momentum().z(), -0.9 * 0.25) << "it was stopped";
  EXPECT_LE((momentum() - momentum_before).norm(), 1e-6 * size);
  // Friction acts across the thickness of contact, up to 1 mm.
  EXPECT_LE((angular() - angular_before).norm(), 1e-3 * 0.1 * size);
}

TEST_P(SecondOrder, SealedAirKeepsPressureTimesVolume) {
  Tent tent("newton", 2e-3, 4e-4, {{"iterations", "20"}, {"tolerance", "1e-10"}});
  integrate_by(tent.world(), GetParam());
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(tent.lift(0.1 * 2e-3));
    ASSERT_NEAR(tent.pressure_times_volume() / (Tent::kAtmosphere * 4e-4), 1.0, 1e-6) << k;
  }
}

TEST_P(SecondOrder, StrainLimitsHold) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 7, 7};
  scene.material = {
      {"stretch_warp", "20"}, {"stretch_weft", "20"}, {"shear", "2"}, {"bending", "1e-5"}};
  scene.fixed = {24};
  scene.time_step = 1.0 / 60.0;
  scene.effects = {{"gravity", {}}, {"strain_limit", {{"max", "1.01"}}}};
  auto world = make_world(scene);
  integrate_by(*world, GetParam());
  double largest = 0.0;
  while (world->time() < 0.6) {
    ASSERT_TRUE(world->step());
    largest = std::max(largest, largest_strain(*world));
  }
  EXPECT_LE(largest, 0.02);
}

}  // namespace
}  // namespace pliant::time_integration_test
