// The stiffness of clusters without their blocks: what its motions say, and what blocks would.
#include "pliant/solvers/linear/shared_stiffnesses.h"

#include <gtest/gtest.h>

#include "pliant/elements/clusters/cluster_set.h"
#include "pliant/solvers/linear/block_matrix.h"
#include "pliant/solvers/linear/coarse_space.h"
#include "support/random.h"
#include "support/solvers/matrices.h"
#include "support/solvers/overlapping_clusters.h"

namespace pliant::shared_stiffnesses_test {
namespace {

constexpr int kParticles = 60, kPinned = 11;
constexpr double kInertia = 3.0;  // [N/m]

/// Overlapping clusters of 25 particles each, and one of three, strained.
struct Clusters {
  Clusters() {
    Random random(4);
    const Positions rest = random.positions(kParticles, 0.1);
    Eigen::VectorXd masses(kParticles);
    for (int i = 0; i < kParticles; ++i) masses[i] = random(0.5, 2.0);
    const std::vector<Cluster> clusters =
        overlapping_clusters(kParticles, 25, 7, 100.0, 300.0, random);
    set = std::make_unique<ClusterSet>(rest, masses, clusters);
    particles = Particles(rest + random.positions(kParticles, 0.02), masses);
    particles.fix(kPinned);
    do {
      matrix.begin(particles, Eigen::VectorXd::Constant(kParticles, kInertia));
      set->add_stiffness(particles.x, Definiteness::kExact, matrix);
    } while (!matrix.finish());
  }
  /// The same with all blocks.
  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd all = stiffness_of(*set, particles.x);
    all.middleRows<3>(3 * kPinned).setZero();
    all.middleCols<3>(3 * kPinned).setZero();
    all.diagonal().array() += kInertia;
    return all;
  }

  std::unique_ptr<ClusterSet> set;
  Particles particles;
  BlockMatrix matrix;
};

TEST(SharedStiffnesses, MultiplyAsTheirBlocksDo) {
  const Clusters clusters;
  const SharedStiffnesses& shared = clusters.matrix.shared();
  ASSERT_EQ(shared.count(), 6);
  const Eigen::Matrix3Xd v = Random(5).positions(kParticles, 1.0);
  Eigen::Matrix3Xd y;
  clusters.matrix.multiply(v, y);
  const Eigen::VectorXd exact = clusters.dense() * v.reshaped();
  EXPECT_NEAR((y.reshaped() - exact).norm(), 0.0, 1e-14 * exact.norm());
  EXPECT_EQ(y.col(kPinned), kInertia * v.col(kPinned));
}

TEST(SharedStiffnesses, KnowTheirDiagonal) {
  const Clusters clusters;
  const Eigen::MatrixXd dense = clusters.dense();
  for (int i = 0; i < kParticles; ++i) {
    const Eigen::Matrix3d exact = dense.block<3, 3>(3 * i, 3 * i);
    EXPECT_NEAR((clusters.matrix.diagonal(i) - exact).norm(), 0.0, 1e-13 * exact.norm()) << i;
  }
}

TEST(SharedStiffnesses, AreWrittenOutWhereFewParticlesShareThem) {
  const Clusters clusters;
  // Of the cluster of three: its blocks beside the diagonal of all.
  EXPECT_EQ(clusters.matrix.entries(), kParticles + 6);
  int sharing = 0;
  clusters.matrix.shared().for_sharing(59, [&](int) {
    ++sharing;
    return true;
  });
  EXPECT_EQ(sharing, 25);
}

TEST(SharedStiffnesses, AnAssemblyAnewForgetsTheLast) {
  Clusters clusters;
  clusters.particles.release(kPinned);
  clusters.matrix.begin(clusters.particles, Eigen::VectorXd::Constant(kParticles, kInertia));
  ASSERT_TRUE(clusters.matrix.finish());
  EXPECT_EQ(clusters.matrix.shared().count(), 0);
  const Eigen::Matrix3Xd v = Random(5).positions(kParticles, 1.0);
  Eigen::Matrix3Xd y;
  clusters.matrix.multiply(v, y);
  EXPECT_EQ(y, kInertia * v);
}

// As in coarse_space_test.cpp: what lies in the space is found exactly.
TEST(SharedStiffnesses, EnterTheCoarseSpaceExactly) {
  Clusters clusters;
  clusters.particles.release(kPinned);
  do {
    clusters.matrix.begin(clusters.particles, Eigen::VectorXd::Constant(kParticles, kInertia));
    clusters.set->add_stiffness(clusters.particles.x, Definiteness::kExact, clusters.matrix);
  } while (!clusters.matrix.finish());
  CoarseSpace coarse;
  coarse.prepare(clusters.matrix, clusters.particles);
  ASSERT_GT(coarse.count(), 1);
  ASSERT_LT(coarse.count(), kParticles / 4);
  coarse.factor(clusters.matrix, HeldRows(), clusters.particles.x);
  Random random(2);
  const Eigen::Vector3d shift = random.vector(1.0), turn = random.vector(3.0);
  Eigen::Matrix3Xd d(3, kParticles), product;
  for (int i = 0; i < kParticles; ++i) {
    d.col(i) = shift + turn.cross(Eigen::Vector3d(clusters.particles.x.col(i)));
  }
  clusters.matrix.multiply(d, product);
  Eigen::Matrix3Xd found = Eigen::Matrix3Xd::Zero(3, kParticles);
  coarse.solve(product);
  for (int i = 0; i < static_cast<int>(found.cols()); ++i) found.col(i) = coarse.correction(i);
  EXPECT_NEAR((found - d).norm(), 0.0, 1e-9 * d.norm());
}

}  // namespace
}  // namespace pliant::shared_stiffnesses_test
