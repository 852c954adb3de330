// Clusters of the CUDA backend, their kernels run by the CPU, against ClusterSet.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>

#include "cuda/core/host_executor.h"
#include "cuda/elements/cluster_arrays.h"
#include "cuda/models/viscoelastic/device_liquid.h"
#include "cuda/solvers/clusters/cluster_fit.h"
#include "cuda/solvers/iteration.h"
#include "cuda/solvers/scenes/joined_system.h"
#include "cuda/solvers/scenes/packed_system.h"
#include "cuda/solvers/step_control.h"
#include "pliant/elements/cloth/spring_set.h"
#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/elements/clusters/oriented_cluster_set.h"
#include "support/random.h"
#include "support/solvers/device_solvers.h"
#include "support/solvers/matrices.h"
#include "support/solvers/solver_systems.h"
#include "support/worlds/draped_cloth.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

constexpr int kParticles = 300;
constexpr double kStiffness = 1e5;

/// Overlapping groups of 1 to 40 neighbours, one of all particles, a flat and a straight one.
std::vector<Cluster> groups(const Positions& rest) {
  std::vector<Cluster> clusters;
  for (int c = 0; c < 60; ++c) {
    std::vector<int> order(static_cast<std::size_t>(rest.cols()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return (rest.col(a) - rest.col(5 * c)).norm() < (rest.col(b) - rest.col(5 * c)).norm();
    });
    order.resize(static_cast<std::size_t>(1 + c % 40));
    clusters.push_back({order, kStiffness * (1 + c % 3)});
  }
  clusters.push_back({std::vector<int>(kParticles), kStiffness});
  std::iota(clusters.back().particles.begin(), clusters.back().particles.end(), 0);
  clusters.push_back({{0, 1, 2}, kStiffness});
  clusters.push_back({{0, 1}, kStiffness});
  return clusters;
}

class DeviceClusters : public testing::Test {
 protected:
  DeviceClusters() {
    Random random(1);
    rest_ = random.positions(kParticles, 0.5);
    masses_ = Eigen::VectorXd::LinSpaced(kParticles, 1e-3, 3e-3);
    auto set = std::make_unique<ClusterSet>(rest_, masses_, groups(rest_));
    set_ = set.get();
    system_.particles = Particles(rest_, masses_);
    system_.elements.push_back(std::move(set));
  }

  /// Of the packed system at `x`, iterated `times` so that fits have something to begin with.
  Forces device_forces(const Positions& x, const PackedSystem& packed, int times = 1) {
    HostExecutor executor;
    ClusterArrays<HostExecutor> arrays;
    ClustersView view;
    arrays.bind(executor, packed.clusters, packed.particles, view);
    std::vector<float> spins;
    pack_spins(system_, packed, spins);
    if (!spins.empty()) arrays.set_spins(executor, spins);
    const double quantum = x.cwiseAbs().maxCoeff() / (1 << 28);
    std::vector<Fixed> places(packed.order.size());
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Eigen::Vector3d at = x.col(packed.order[k]) / quantum;
      places[k] = {static_cast<int>(at[0]), static_cast<int>(at[1]), static_cast<int>(at[2]), 0.0f};
    }
    StepRules rules;
    rules.quantum = static_cast<float>(quantum);
    StepControl control;
    ControlStep::begin(control, rules);
    Acceleration accelerate{};
    accelerate.arrays.particles = packed.particles;
    accelerate.arrays.block = packed.block;
    accelerate.arrays.x[0] = places.data();
    accelerate.arrays.rules = &rules;
    accelerate.arrays.control = &control;
    for (int k = 0; k < times; ++k) launch_fits(executor, view, accelerate);
    Forces f = Forces::Zero(3, x.cols());
    for (std::size_t k = 0; k < places.size(); ++k) {
      const Float3 own =
          pull_of_clusters(view, places[k], static_cast<int>(k), static_cast<float>(quantum));
      f.col(packed.order[k]) = Eigen::Vector3d(own.x, own.y, own.z);
    }
    return f;
  }

  /// Σ k m over a particle's clusters times the body's size bounds each part of its force, which
  /// single precision keeps to a few roundings.
  void expect_same_forces(const Positions& x, const PackedSystem& packed) {
    const Forces exact = forces_of(*set_, x), found = device_forces(x, packed);
    const double scale = 20.0 * 2.0 * kStiffness * masses_.maxCoeff() * x.cwiseAbs().maxCoeff();
    EXPECT_LE((found - exact).cwiseAbs().maxCoeff(), 16 * 6e-8 * scale);
    EXPECT_GT(exact.cwiseAbs().maxCoeff(), 1e-3 * scale);
  }

  Positions deformed(double amount) {
    Random random(2);
    return (random.rotation() * rest_ + random.positions(kParticles, amount)).colwise() +
           Eigen::Vector3d(0.3, 0.1, -0.2);
  }

  Positions rest_;
  Eigen::VectorXd masses_;
  ProjectiveSystem system_;
  ClusterSet* set_ = nullptr;
};

TEST_F(DeviceClusters, PullAsOnTheCpu) {
  const PackedSystem packed = pack(system_, 64);
  EXPECT_FALSE(packed.clusters.rest.empty());
  for (double amount : {0.05, 0.5}) expect_same_forces(deformed(amount), packed);
}

TEST_F(DeviceClusters, IterationsThatReadTheMatrixAreThoseOfTheCpu) {
  constexpr int kCount = 6;
  const Positions start = deformed(0.05);
  for (const char* name : {"line_search_jacobi", "hybrid"}) {
    const auto cpu = make_solver(name, iterations(kCount));
    const auto device = make_host_device_solver(name, {kCount, 0.0, 0.0});
    for (double dt : {0.01, 0.004}) {  // of another length the device packs nothing anew
      const auto after = [&](Solver& solver) {
        system_.particles = Particles(start, masses_);
        system_.external_forces.setZero(3, kParticles);
        solver.prepare(system_, dt);
        step_of(system_, solver, dt);
        return system_.particles.x;
      };
      const Positions exact = after(*cpu), found = after(*device);
      EXPECT_LE((found - exact).cwiseAbs().maxCoeff(), single_round_off(exact, kCount)) << name;
      EXPECT_GT((exact - start).cwiseAbs().maxCoeff(), 100 * single_round_off(exact, kCount));
    }
  }
}

TEST_F(DeviceClusters, LbfgsConvergesAsOnTheCpu) {
  const Positions start = deformed(0.05);
  const auto after = [&](Solver& solver) {
    system_.particles = Particles(start, masses_);
    system_.external_forces.setZero(3, kParticles);
    solver.prepare(system_, 0.01);
    step_of(system_, solver, 0.01);
    return system_.particles.x;
  };
  const Positions exact = after(*make_solver("lbfgs", iterations(60)));
  const Positions found = after(*make_host_device_solver("lbfgs", {30, 0.0, 0.0}));
  EXPECT_LE((found - exact).norm(), 1e-4 * (exact - start).norm());
}

TEST_F(DeviceClusters, PullAsOnTheCpuWhereShapesDoNotFitTogether) {
  set_->creep(deformed(0.2), 0.01, 0.5);
  const PackedSystem packed = pack(system_, 64);
  EXPECT_TRUE(packed.clusters.rest.empty());
  for (double amount : {0.05, 0.5}) expect_same_forces(deformed(amount), packed);
}

TEST_F(DeviceClusters, FollowWeights) {
  Eigen::VectorXd weights = Eigen::VectorXd::LinSpaced(kParticles, 0.0, 1.0);
  set_->set_weights(weights, rest_);
  const PackedSystem melted = pack(system_, 64);
  EXPECT_FALSE(melted.clusters.rest.empty());
  expect_same_forces(deformed(0.1), melted);
  weights.head(100).setOnes();
  set_->set_weights(weights, deformed(0.1));
  const PackedSystem frozen = pack(system_, 64);
  EXPECT_TRUE(frozen.clusters.rest.empty());
  expect_same_forces(deformed(0.3), frozen);
}

TEST_F(DeviceClusters, ChangesAreTold) {
  std::vector<long> last = structure_of(system_);
  ASSERT_FALSE(last.empty());
  const auto is_new = [&] {
    const std::vector<long> now = structure_of(system_);
    return now != std::exchange(last, now);
  };
  system_.particles.x = deformed(0.2);
  EXPECT_FALSE(is_new());
  set_->creep(deformed(0.2), 100.0, 0.5);
  EXPECT_FALSE(is_new()) << "nothing yields";
  set_->creep(deformed(0.2), 0.01, 0.5);
  EXPECT_TRUE(is_new());
  set_->set_weights(Eigen::VectorXd::Constant(kParticles, 0.5), rest_);
  EXPECT_TRUE(is_new());
  set_->set_stiffness(3, 2.0 * kStiffness);
  EXPECT_TRUE(is_new());
  system_.elements.push_back(
      std::make_unique<SpringSet>("stretch", std::vector<Spring>(), kParticles));
  EXPECT_TRUE(structure_of(system_).empty()) << "springs do not tell";
}

TEST_F(DeviceClusters, AtRestTheyPullByRoundOffAlone) {
  const PackedSystem packed = pack(system_, 64);
  const Positions x = deformed(0.0);
  const double scale = 20.0 * 2.0 * kStiffness * masses_.maxCoeff() * x.cwiseAbs().maxCoeff();
  EXPECT_LE(device_forces(x, packed, 3).cwiseAbs().maxCoeff(), 16 * 6e-8 * scale);
}

TEST_F(DeviceClusters, MeetTheConvergedStep) {
  system_.particles.fix(3);
  Random random(4);
  system_.particles.v = random.positions(kParticles, 0.5);
  system_.external_forces.setZero(3, kParticles);
  pull_down(system_);
  constexpr double kStep = 0.01;
  const Particles start = system_.particles;
  const auto step = [&](Solver& solver) {
    system_.particles = start;
    solver.prepare(system_, kStep);
    step_of(system_, solver, kStep);
    return system_.particles.x;
  };
  const auto newton = make_solver("newton", {{"iterations", "300"}, {"tolerance", "1e-13"}});
  const Positions exact = step(*newton);
  for (const char* name : {"jacobi", "chebyshev"}) {
    const Positions found = step(*make_host_device_solver(name, {3000, 0.0, 0.0}));
    // Offsets within the cluster of all particles are rounded to 6e-8 of its size, 1 m.
    EXPECT_LE((found - exact).colwise().norm().maxCoeff(), 16 * 6e-8) << name;
  }
}

TEST_F(DeviceClusters, OfJoinedScenesPullAsAlone) {
  const PackedSystem packed = pack(system_, 64);
  const PackedSystem joined = join({&packed, &packed});
  ASSERT_EQ(joined.clusters.size(), 2 * packed.clusters.size());
  const Positions x = deformed(0.1);
  const Forces alone = device_forces(x, packed);
  // Places of the second scene begin with a block of their own.
  PackedSystem both = joined;
  const int first = packed.blocks * packed.block;
  both.order.assign(static_cast<std::size_t>(joined.particles), 0);
  for (std::size_t k = 0; k < packed.order.size(); ++k) {
    both.order[k] = packed.order[k];
    both.order[static_cast<std::size_t>(first) + k] = kParticles + packed.order[k];
  }
  Positions twice(3, 2 * kParticles);
  twice << x, x;
  const Forces found = device_forces(twice, both);
  EXPECT_EQ(found.rightCols(kParticles - 1), alone.rightCols(kParticles - 1));
}

/// With particles that have turned, each in another way.
TEST_F(DeviceClusters, OfOrientedParticlesPullAsOnTheCpu) {
  Random random(3);
  std::vector<Eigen::Matrix3d> moments;
  for (int i = 0; i < kParticles; ++i) {
    moments.push_back(ellipsoid_moment(masses_[i], {0.02, 0.03, 0.05}));
  }
  auto set = std::make_unique<OrientedClusterSet>(rest_, masses_, moments, groups(rest_));
  for (int i = 0; i < kParticles; ++i) {
    set->set_orientation(i, Eigen::Quaterniond(random.rotation()), Eigen::Vector3d::Zero());
  }
  set_ = set.get();
  system_.elements.front() = std::move(set);
  const PackedSystem packed = pack(system_, 64);
  EXPECT_TRUE(packed.clusters.is_oriented);
  for (double amount : {0.05, 0.5}) expect_same_forces(deformed(amount), packed);
  // They matter.
  const Forces turned = forces_of(*set_, deformed(0.05));
  set_->reset();
  EXPECT_GT((forces_of(*set_, deformed(0.05)) - turned).norm(), 1e-3 * turned.norm());
}

/// The same body moved by the CPU and by a device; `change` may alter it before each step.
template <class Change>
void expect_same_path(const ViscoelasticModel::Material& material, int steps,
                      const Change& change) {
  const auto make = [&] {
    auto world =
        std::make_unique<ParticleWorld>(sampled_box({0.05, 0.04, 0.04}, 0.01), material, 0.005);
    world->model().place(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.025)));
    Obstacle plane;
    plane.name = "plane";
    plane.shape = std::make_shared<Plane>();
    plane.pose_start = plane.pose_end = Eigen::Isometry3d::Identity();
    world->world().add_obstacle(plane);
    world->add_effect("gravity");
    world->add_effect("contact");
    world->add_effect("friction");
    world->start("chebyshev", {{"iterations", "500"}, {"tolerance", "1e-8"}});
    return world;
  };
  const auto cpu = make(), device = make();
  device->model().system().liquid.set_device(std::make_unique<DeviceLiquid<HostExecutor>>());
  device->body().solver = make_host_device_solver("chebyshev", {300, 1e-6, 0.0});
  device->world().system_changed();
  int contacts = 0;
  for (int s = 0; s < steps; ++s) {
    change(s, cpu->model());
    change(s, device->model());
    ASSERT_TRUE(cpu->world().step()) << cpu->world().failure();
    ASSERT_TRUE(device->world().step()) << device->world().failure();
    contacts = std::max(contacts, cpu->body().report.contacts);
    const double off = (cpu->particles().x - device->particles().x).colwise().norm().maxCoeff();
    ASSERT_LE(off, 1e-4 * 0.05) << "step " << s;
  }
  // The walls of a liquid hold it off.
  EXPECT_EQ(contacts > 0, material.beta == 0.0);
}

TEST(DeviceClustersOf, AnElasticBlockFallLikeThoseOfTheCpu) {
  expect_same_path({}, 40, [](int, ViscoelasticModel&) {});
}

TEST(DeviceClustersOf, ABlockThatMeltsAndFreezesFollowIt) {
  expect_same_path({}, 25, [](int s, ViscoelasticModel& model) {
    for (int i = 0; i < model.particles().size(); i += 2) {
      if (s == 6) model.set_beta(i, 0.5);
      if (s == 14) model.set_beta(i, 0.1);
    }
  });
}

TEST(DeviceClustersOf, ABlockThatCreepsDoes) {
  ViscoelasticModel::Material material;
  material.solid.young = 2e3;
  expect_same_path(material, 30, [](int, ViscoelasticModel& model) {
    model.creep(model.particles().x, 0.01, 0.2);
  });
}

TEST(DeviceClustersOf, ABlockOfOrientedParticlesDoes) {
  ViscoelasticModel::Material material;
  material.oriented = true;
  expect_same_path(material, 40, [](int s, ViscoelasticModel& model) {
    if (s == 10) model.set_beta(3, 0.5);
  });
}

TEST(DeviceClustersOf, ABlockBetweenSolidAndLiquidDoes) {
  ViscoelasticModel::Material material;
  material.beta = 0.5;
  material.liquid.viscosity = 2.0;
  expect_same_path(material, 25, [](int, ViscoelasticModel&) {});
}

}  // namespace
}  // namespace pliant
