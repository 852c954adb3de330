// Resident runs: steps between which the body stays on the device, their kernels run by the CPU.
// They are the steps that the host takes one by one.
#include <gtest/gtest.h>

#include <functional>

#include "pliant/effects/attachment.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/host_device_solver.h"
#include "support/worlds/patch_worlds.h"

namespace pliant::device_resident_run_test {
namespace {

std::unique_ptr<World> falling_cloth(const std::vector<Obstacle>& obstacles, double height,
                                     double time_step = 0.005) {
  ClothScene scene;
  scene.grid = {0.3, 0.3, 9, 9};
  scene.pose = at(0.02, 0.01, height);
  // Stiff against bending and damped: in a cloth that buckles the last bit decides where to.
  scene.material = {
      {"stretch_warp", "100"}, {"stretch_weft", "100"}, {"shear", "20"}, {"bending", "1e-3"}};
  scene.obstacles = obstacles;
  scene.effects = {{"gravity", {}},
                   {"damping", {{"rate", "4"}}},
                   {"contact", {}},
                   {"friction", {{"coefficient", "0.4"}}}};
  scene.time_step = time_step;
  return make_world(scene);
}

void use_device(World& world, const std::string& solver, int iterations = 30) {
  body_of(world).solver = make_host_device_solver(solver, {iterations, 0.0, 0.0});
  world.system_changed();
}

double size_of(const World& world) {
  const Positions& x = world.bodies().front().particles().x;
  return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

double distance(const World& a, const World& b) {
  return (a.bodies().front().particles().x - b.bodies().front().particles().x)
      .colwise()
      .norm()
      .maxCoeff();
}

/// Made when its test runs: sampling a mesh takes as long as many tests.
struct Ground {
  const char* name;
  std::function<Obstacle()> obstacle;
  double height;  ///< at which cloth begins, just above
};

std::vector<Ground> grounds() {
  const Eigen::Isometry3d lying(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()));
  const Eigen::Isometry3d tilted =
      at(0, 0, 0) * Eigen::AngleAxisd(0.2, Eigen::Vector3d(1, 2, 0).normalized());
  return {{"Plane", [=] { return obstacle(Plane(), tilted); }, 0.05},
          {"Sphere", [] { return obstacle(Sphere(0.1)); }, 0.105},
          {"Box",
           [=] {
             return obstacle(Box({0.2, 0.1, 0.1}), tilted);
           },
           0.075},
          {"Capsule", [=] { return obstacle(Capsule(0.05, 0.1), lying); }, 0.055},
          {"Cylinder", [=] { return obstacle(Cylinder(0.05, 0.2), lying); }, 0.055},
          {"Mesh", [=] { return obstacle(MeshShape(Sphere(0.1).surface()), tilted); }, 0.105}};
}

class DeviceResidentRunOn : public testing::TestWithParam<Ground> {};
INSTANTIATE_TEST_SUITE_P(Obstacles, DeviceResidentRunOn, testing::ValuesIn(grounds()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(DeviceResidentRunOn, IsTheStepsOneByOne) {
  constexpr int kSteps = 40;
  for (const char* solver : {"jacobi", "chebyshev"}) {
    const auto single = falling_cloth({GetParam().obstacle()}, GetParam().height);
    const auto resident = falling_cloth({GetParam().obstacle()}, GetParam().height);
    // Converged: the path of a recurrence that is cut off hangs on the last bit.
    use_device(*single, solver, 400);
    use_device(*resident, solver, 400);
    EXPECT_EQ(resident->resident_limit(kSteps), 0)
        << "what came before the first step is not known";
    ASSERT_TRUE(resident->step());
    ASSERT_GE(resident->resident_limit(kSteps), 2);
    for (int k = 0; k < kSteps; ++k) ASSERT_TRUE(single->step());
    ASSERT_TRUE(resident->advance(kSteps - 1));
    EXPECT_EQ(resident->steps(), single->steps());
    EXPECT_EQ(resident->time(), single->time());
    EXPECT_LE(distance(*resident, *single), 1e-4 * size_of(*single)) << solver;
    const Particles& p = body_of(*resident).particles();
    EXPECT_LE((p.x - p.x_start - 0.005 * std::exp(4 * 0.005) * p.v).norm(),
              1e-6 * size_of(*single));
    EXPECT_GT(body_of(*resident).report.contacts, 0);
    // Contact of a cloth in motion: forces of single steps differ by what positions do.
    const Eigen::Vector3d force = single->reactions()[0].force;
    EXPECT_LE((resident->reactions()[0].force - force).norm(), 0.05 * force.norm()) << solver;
  }
}

TEST(DeviceResidentRun, FreeFallIsExactForAnyTimeStep) {
  for (double dt : {0.005, 1.0 / 12000.0}) {
    constexpr int kSteps = 1000;
    const auto world = falling_cloth({obstacle(Plane())}, 1e3, dt);
    use_device(*world, "chebyshev");
    const double before = particles_of(*world).x.row(2).mean();
    ASSERT_TRUE(world->advance(kSteps));
    // v ← (v - g h) e^(-r h), x ← x + h (v - g h)
    double v = 0.0, displacement = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      displacement += dt * (v - 9.81 * dt);
      v = (v - 9.81 * dt) * std::exp(-4 * dt);
    }
    const Particles& p = particles_of(*world);
    // What a step loses is half a quantum, of 2^-28 of the few body sizes that a run goes, and
    // the last bit of the velocity; damping forgets it after a while.
    const double quantum = 3.0 * size_of(*world) / (1 << 28);
    const double bits = 6e-8 * std::min<double>(kSteps, 1.0 / (4.0 * dt));
    EXPECT_LE((p.v.row(2).array() - v).abs().maxCoeff(), bits * std::abs(v) + quantum / dt);
    EXPECT_NEAR(p.x.row(2).mean() - before, displacement,
                kSteps * quantum + bits * std::abs(displacement));
  }
}

/// About the cloth's centre, over its mass [m²/s].
Eigen::Vector3d spin_of(const World& world) {
  const Particles& p = world.bodies().front().particles();
  const double mass = p.mass.sum();
  const Eigen::Vector3d center = p.x * p.mass / mass, velocity = p.v * p.mass / mass;
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  for (int i = 0; i < p.size(); ++i) {
    spin += p.mass[i] / mass * (p.x.col(i) - center).cross(p.v.col(i) - velocity);
  }
  return spin;
}

ParameterText stiff_fabric(double stiffness) {
  return {{"stretch_warp", std::to_string(stiffness)},
          {"stretch_weft", std::to_string(stiffness)},
          {"shear", std::to_string(0.1 * stiffness)},
          {"bending", "1e-3"}};
}

TEST(DeviceResidentRun, FewIterationsKeepTheMomentumOfAStiffBody) {
  constexpr int kSteps = 20;
  for (const char* solver : {"jacobi", "chebyshev", "line_search_jacobi", "hybrid", "lbfgs"}) {
    ClothScene scene;
    scene.material = stiff_fabric(1e4);
    scene.effects = {{"gravity", {}}};
    const auto world = make_world(scene);
    use_device(*world, solver, 5);
    ASSERT_TRUE(world->step());
    Particles& p = body_of(*world).particles();
    const double mass = p.mass.sum(), dt = world->time_step();
    const Eigen::Vector3d center = p.x * p.mass / mass, turns(1.0, 2.0, 10.0);  // [m, 1/s]
    for (int i = 0; i < p.size(); ++i) p.v.col(i) += turns.cross(p.x.col(i) - center);
    const Eigen::Vector3d velocity = p.v * p.mass / mass, spin = spin_of(*world);
    ASSERT_GE(world->resident_limit(kSteps), 2) << solver;
    ASSERT_TRUE(world->advance(kSteps));
    const Eigen::Vector3d fallen(0.0, 0.0, -9.81 * kSteps * dt), now = p.v * p.mass / mass;
    EXPECT_LE((now - velocity - fallen).norm(), 1e-5 * fallen.norm()) << solver;
    // A step of implicit Euler keeps it about where it ends, of the displacement in the step.
    EXPECT_LE((spin_of(*world) - spin).norm(), 0.1 * spin.norm()) << solver;
  }
}

/// Lies on an incline that turned by the angle of tangent 0.75.
struct OnIncline {
  std::unique_ptr<World> world;
  Eigen::Vector3d velocity() const {
    const Particles& p = world->bodies().front().particles();
    return p.v * p.mass / p.mass.sum();
  }
};

OnIncline cloth_on_incline(double stiffness, const char* solver, int iterations, int side = 9) {
  const Eigen::Isometry3d tilted(Eigen::AngleAxisd(std::atan(0.75), Eigen::Vector3d::UnitY()));
  ClothScene scene;
  scene.grid = {0.3, 0.3, side, side};
  scene.pose = tilted * at(0, 0, 0.0105);
  scene.material = stiff_fabric(stiffness);
  scene.obstacles = {obstacle(Plane(), tilted)};
  scene.effects = {{"gravity", {}}, {"contact", {}}, {"friction", {{"coefficient", "0.5"}}}};
  auto world = make_world(scene);
  use_device(*world, solver, iterations);
  EXPECT_TRUE(world->step());
  return {std::move(world)};
}

TEST(DeviceResidentRun, FewIterationsLetAStiffClothSlideAsItShould) {
  constexpr int kSteps = 40;
  constexpr double kExact = 9.81 * (0.6 - 0.5 * 0.8);  // [m/s²]
  for (const char* solver : {"jacobi", "chebyshev", "line_search_jacobi", "hybrid", "lbfgs"}) {
    for (double stiffness : {1e2, 1e4, 1e6}) {
      const OnIncline cloth = cloth_on_incline(stiffness, solver, 5);
      ASSERT_GE(cloth.world->resident_limit(kSteps), 2) << solver;
      ASSERT_TRUE(cloth.world->advance(kSteps));
      const Eigen::Vector3d before = cloth.velocity();
      ASSERT_TRUE(cloth.world->advance(kSteps));
      const double gained = (cloth.velocity() - before).norm();
      EXPECT_NEAR(gained / (kSteps * cloth.world->time_step()), kExact, 0.02 * kExact)
          << solver << " at " << stiffness << " N/m";
      const double weight = 9.81 * particles_of(*cloth.world).mass.sum();
      const double pressed = 0.8 * std::sqrt(1.25) * weight;
      EXPECT_NEAR(cloth.world->reactions()[0].force.norm(), pressed, 0.02 * pressed)
          << solver << " at " << stiffness << " N/m";
    }
  }
}

TEST(DeviceResidentRun, ForcesThatBalanceNothingAreTold) {
  const auto tells = [](const World& world) {
    const auto& warnings = world.bodies().front().report.warnings;
    return std::any_of(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.find("contact_unbalanced") == 0;
    });
  };
  // Much stiffer than five iterations can know, of many vertices in contact.
  for (double stiffness : {1e4, 1e6}) {
    const OnIncline cloth = cloth_on_incline(stiffness, "chebyshev", 5, 49);
    ASSERT_TRUE(cloth.world->advance(40));
    EXPECT_EQ(tells(*cloth.world), stiffness > 1e5) << stiffness;
  }
}

TEST(DeviceResidentRun, NothingTunnelsThroughThinBoxes) {
  const auto world = falling_cloth({obstacle(Box({1.0, 1.0, 1e-4}))}, 0.3);
  use_device(*world, "jacobi");
  ASSERT_TRUE(world->step());
  body_of(*world).particles().v.row(2).setConstant(-30.0);
  ASSERT_TRUE(world->advance(30));
  EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), 0.0);
  EXPECT_GT(world->reactions()[0].force.norm(), 0.0);
}

TEST(DeviceResidentRun, NothingTunnelsThroughAMeshThinnerThanAStep) {
  const MeshShape plate(Box({0.5, 0.5, 0.02}).surface());
  const auto world = falling_cloth({obstacle(plate)}, 0.3);
  use_device(*world, "jacobi");
  ASSERT_TRUE(world->step());
  body_of(*world).particles().v.row(2).setConstant(-30.0);
  ASSERT_GE(world->resident_limit(30), 2);
  ASSERT_TRUE(world->advance(30));
  EXPECT_GE(particles_of(*world).x.row(2).minCoeff(), 0.01);
  EXPECT_GT(world->reactions()[0].force.norm(), 0.0);
}

TEST(DeviceResidentRun, FixedParticlesStay) {
  ClothScene scene;
  scene.fixed = {0, 6};
  scene.effects = {{"gravity", {}}};
  const auto world = make_world(scene);
  use_device(*world, "chebyshev");
  const Positions before = particles_of(*world).x;
  ASSERT_TRUE(world->step());
  ASSERT_GE(world->resident_limit(20), 2);
  ASSERT_TRUE(world->advance(20));
  const Particles& p = particles_of(*world);
  for (int i : scene.fixed) EXPECT_EQ(p.x.col(i), before.col(i));
  EXPECT_LT(p.x.row(2).minCoeff(), -0.01);
}

TEST(DeviceResidentRun, AttachmentsHold) {
  std::vector<std::unique_ptr<World>> worlds;
  for (int k = 0; k < 2; ++k) {
    auto world = falling_cloth({obstacle(Sphere(0.05), at(0.3, 0, 0))}, 0.2);
    AttachmentRequest request;
    request.name = "corner";
    request.region.kind = Region::Kind::kSphere;
    request.region.center = particles_of(*world).x.col(0);
    request.region.radius = 0.05;
    request.count = particles_of(*world).size();
    request.obstacle = 0;
    request.stiffness = 100.0;
    attachments_of(body_of(*world), world->obstacles()).add(request);
    use_device(*world, "chebyshev", 400);
    ASSERT_TRUE(world->step());
    worlds.push_back(std::move(world));
  }
  World &single = *worlds[0], &resident = *worlds[1];
  ASSERT_EQ(resident.resident_limit(30), 30);
  ASSERT_TRUE(resident.advance(30));
  for (int k = 0; k < 30; ++k) ASSERT_TRUE(single.step());
  EXPECT_LE(distance(resident, single), 1e-4 * size_of(single));
  const Eigen::Vector3d force = single.reactions()[0].force;
  EXPECT_LT(force[2], 0.0) << "it hangs";
  EXPECT_LE((resident.reactions()[0].force - force).norm(), 0.01 * force.norm());
}

TEST(DeviceResidentRun, RepeatsBitForBit) {
  std::vector<Positions> ends;
  for (int run = 0; run < 2; ++run) {
    const auto world = falling_cloth({obstacle(Sphere(0.1))}, 0.105);
    use_device(*world, "chebyshev");
    ASSERT_TRUE(world->advance(30));
    ends.push_back(particles_of(*world).x);
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(DeviceResidentRun, WhatCannotStayOnTheDeviceStepsOneByOne) {
  const std::vector<Obstacle> nine(9, obstacle(Sphere(0.1)));
  const auto crowded = falling_cloth(nine, 0.105);
  use_device(*crowded, "jacobi");
  ASSERT_TRUE(crowded->step());
  EXPECT_EQ(crowded->resident_limit(10), 0) << "more obstacles than it looks at";
  ASSERT_TRUE(crowded->advance(3));
  EXPECT_EQ(crowded->steps(), 4u);

  PatchScene scene = falling_block("jacobi", {});
  const auto block = make_world(scene);
  use_device(*block, "jacobi");
  ASSERT_TRUE(block->step());
  EXPECT_EQ(block->resident_limit(10), 0) << "contact points that share particles";

  const auto pushed = falling_cloth({obstacle(Sphere(0.1))}, 0.105);
  ASSERT_TRUE(pushed->step());
  EXPECT_EQ(pushed->resident_limit(10), 0) << "a solver of the CPU";
  use_device(*pushed, "jacobi");
  EXPECT_EQ(pushed->resident_limit(1), 0);
  EXPECT_EQ(pushed->resident_limit(10), 10);
}

TEST(DeviceResidentRun, WhatLeavesAllBoundsIsUndone) {
  const auto world = falling_cloth({}, 0.1);
  use_device(*world, "jacobi", 3);
  ASSERT_TRUE(world->step());
  body_of(*world).particles().v(0, 0) = std::nan("");
  const Positions before = particles_of(*world).x;
  EXPECT_FALSE(world->advance(10));
  EXPECT_EQ(particles_of(*world).x, before);
  EXPECT_NE(world->failure().find("vertex 0"), std::string::npos) << world->failure();
}

std::unique_ptr<World> watched_cloth(const char* solver) {
  auto world = falling_cloth({obstacle(Sphere(0.1))}, 0.105);
  use_device(*world, solver);
  EXPECT_TRUE(world->step());
  return world;
}

struct Seen {
  std::uint64_t step;
  Positions x, v;
  int following;  ///< steps that were under way
};

/// So many steps on end; what was seen every `every` of them.
std::vector<Seen> watch(World& world, int steps, int every) {
  std::vector<Seen> seen;
  const auto& solver = dynamic_cast<DeviceSolver<HostExecutor>&>(*body_of(world).solver);
  EXPECT_TRUE(world.advance(steps, every, [&](const World& now) {
    const Particles& p = now.bodies().front().particles();
    seen.push_back({now.steps(), p.x, p.v, solver.following()});
    return true;
  }));
  return seen;
}

TEST(DeviceResidentRun, WhatIsSeenIsWhatNoStepUnderWayChanges) {
  for (const char* name : {"chebyshev", "lbfgs"}) {
    const auto world = watched_cloth(name);
    const std::vector<Seen> all = watch(*world, 40, 10);
    ASSERT_EQ(all.size(), 4u);
    for (std::size_t k = 0; k < all.size(); ++k) {
      EXPECT_EQ(all[k].step, 10 * k + 11);
      EXPECT_EQ(all[k].following, k < 3 ? 10 : 0) << name << " " << k;
      if (k % 2 == 0) continue;
      // Downloaded with nothing under way.
      const auto alone = watched_cloth(name);
      const Seen last = watch(*alone, static_cast<int>(10 * k + 10), 10).back();
      EXPECT_EQ(all[k].x, last.x) << name << " " << k;
      EXPECT_EQ(all[k].v, last.v);
    }
    EXPECT_GT(body_of(*world).report.contacts, 0);
    EXPECT_GT(world->reactions()[0].force.norm(), 0.0);
  }
}

TEST(DeviceResidentRun, WhatIsUnderWayIsForgottenWhereNobodyWantsIt) {
  const auto stopped = watched_cloth("chebyshev"), exact = watched_cloth("chebyshev");
  int observations = 0;
  ASSERT_TRUE(stopped->advance(40, 10, [&](const World&) { return ++observations < 2; }));
  watch(*exact, 20, 10);
  EXPECT_EQ(stopped->steps(), exact->steps());
  EXPECT_EQ(particles_of(*stopped).x, particles_of(*exact).x);
  for (World* world : {stopped.get(), exact.get()}) {
    ASSERT_TRUE(world->advance(10));
    ASSERT_TRUE(world->step());
  }
  EXPECT_EQ(particles_of(*stopped).x, particles_of(*exact).x);
}

TEST(DeviceResidentRun, WhatLeavesAllBoundsWhileItIsObservedIsUndone) {
  const auto world = watched_cloth("chebyshev");
  world->finite_check().max_distance = 1.0;  // of a body that falls past the ball
  body_of(*world).particles().v.row(0).setConstant(4.0);
  std::vector<double> means;
  EXPECT_FALSE(world->advance(200, 10, [&](const World& now) {
    means.push_back(now.bodies().front().particles().x.row(0).mean());
    return true;
  }));
  ASSERT_GT(means.size(), 3u);
  for (std::size_t k = 1; k < means.size(); ++k) EXPECT_GT(means[k], means[k - 1]);
  EXPECT_FALSE(world->failure().empty());
}

}  // namespace
}  // namespace pliant::device_resident_run_test
