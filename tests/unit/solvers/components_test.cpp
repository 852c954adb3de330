// What holds together, and what turns freely.
#include "pliant/solvers/components/components.h"

#include <gtest/gtest.h>

#include "pliant/elements/clusters/oriented_cluster_set.h"
#include "pliant/solvers/components/rigid_modes.h"
#include "support/random.h"

namespace pliant::components_test {
namespace {

constexpr double kStiffness = 100.0;  // [1/s²]

/// Particles first, first + 1, ... as a cluster.
Cluster cluster(int first, int count) {
  Cluster result{{}, kStiffness, {}};
  for (int i = first; i < first + count; ++i) result.particles.push_back(i);
  return result;
}

std::unique_ptr<ProjectiveSystem> clusters(int particles, const std::vector<Cluster>& all,
                                           bool oriented) {
  auto system = std::make_unique<ProjectiveSystem>();
  const Positions rest = Random(1).positions(particles, 1.0);
  const Eigen::VectorXd masses = Eigen::VectorXd::Ones(particles);
  system->particles = Particles(rest, masses);
  if (oriented) {
    const std::vector<Eigen::Matrix3d> moments(static_cast<std::size_t>(particles),
                                               Eigen::Matrix3d::Identity());
    system->elements.push_back(std::make_unique<OrientedClusterSet>(rest, masses, moments, all));
  } else {
    system->elements.push_back(std::make_unique<ClusterSet>(rest, masses, all));
  }
  return system;
}

TEST(ComponentsOfClusters, OfClustersThatShareParticles) {
  const auto system = clusters(10, {cluster(0, 4), cluster(3, 3), cluster(7, 2)}, false);
  const Components found = find_components(*system);
  EXPECT_EQ(found.of, (std::vector<int>{0, 0, 0, 0, 0, 0, 1, 2, 2, 3}));
  EXPECT_EQ(found.held, std::vector<bool>(4, false));
  EXPECT_EQ(found.twisted, std::vector<bool>(4, false));
}

TEST(ComponentsOfClusters, APinnedParticleHoldsTheClustersThatItIsIn) {
  const auto system = clusters(8, {cluster(0, 4), cluster(4, 4)}, false);
  system->particles.fix(1);
  const Components found = find_components(*system);
  EXPECT_EQ(found.of, (std::vector<int>{0, Components::kNone, 0, 0, 1, 1, 1, 1}));
  EXPECT_EQ(found.held, (std::vector<bool>{true, false}));
}

// A rigid body of particles: no matrix has the entries of so many.
TEST(ComponentsOfClusters, AClusterOfThousandsIsOne) {
  const auto system = clusters(3000, {cluster(0, 3000)}, false);
  const Components found = find_components(*system);
  ASSERT_EQ(found.count(), 1);
  EXPECT_FALSE(found.held[0]);
}

// Elements that turn oriented particles give their positions a torque: it is no angular momentum
// that iterations lost.
TEST(ComponentsOfClusters, OfOrientedParticlesAreMovedButNotTurned) {
  for (const bool oriented : {false, true}) {
    const auto system = clusters(6, {cluster(0, 6)}, oriented);
    Components found = find_components(*system);
    EXPECT_EQ(found.twisted, std::vector<bool>{oriented});
    RigidModes modes;
    modes.prepare(std::move(found), system->particles.mass);
    modes.update(system->particles.x);
    const Forces force = Random(7).positions(6, 1.0);
    Eigen::VectorXd motions;
    modes.find_motions([&](int i) { return Eigen::Vector3d(force.col(i)); }, {}, 0.0, motions);
    EXPECT_NEAR((motions.head<3>() - force.rowwise().sum() / 6.0).norm(), 0.0, 1e-14);
    EXPECT_EQ(motions.tail<3>().norm() > 0.0, !oriented);
    // But as what is moved as a rigid body, it turns.
    modes.let_all_turn(true);
    modes.update(system->particles.x);
    modes.find_motions([&](int i) { return Eigen::Vector3d(force.col(i)); }, {}, 0.0, motions);
    EXPECT_GT(motions.tail<3>().norm(), 0.0);
  }
}

}  // namespace
}  // namespace pliant::components_test
