#include "pliant/elements/clusters/cluster_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "support/expect_refusal.h"
#include "support/random.h"
#include "support/solvers/matrices.h"

namespace pliant {
namespace {

Cluster all_of(int particles, double stiffness) {
  Cluster cluster{std::vector<int>(static_cast<std::size_t>(particles)), stiffness};
  std::iota(cluster.particles.begin(), cluster.particles.end(), 0);
  return cluster;
}

/// Rest shapes of a cluster by name, 5 particles but for `single`.
Positions shape(const std::string& name) {
  Random random(5);
  Positions rest = random.positions(name == "single" ? 1 : 5, 0.1);
  if (name == "flat") rest.row(2).setZero();
  if (name == "straight") rest.bottomRows(2).setZero();
  if (name == "tilted_straight") {
    rest = (Eigen::Vector3d(1, 2, 3) * Eigen::RowVectorXd::LinSpaced(5, -0.1, 0.1)).eval();
  }
  if (name == "coincident") rest.setConstant(0.3);
  return rest;
}

class AnyShape : public testing::TestWithParam<std::string> {
 protected:
  Positions rest_ = shape(GetParam());
  int n_ = static_cast<int>(rest_.cols());
  Eigen::VectorXd masses_ = Eigen::VectorXd::LinSpaced(n_, 1e-3, 3e-3);
  ClusterSet set_{rest_, masses_, {all_of(n_, 1e5)}};
};

INSTANTIATE_TEST_SUITE_P(Clusters, AnyShape,
                         testing::Values("solid", "flat", "straight", "tilted_straight",
                                         "coincident", "single"),
                         [](const auto& info) { return info.param; });

TEST_P(AnyShape, RigidMotionCostsNothing) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const Positions x = (random.rotation() * rest_).colwise() + random.vector(1.0);
    EXPECT_NEAR(set_.energy(x), 0.0, 1e-27);
    EXPECT_LE(forces_of(set_, x).norm(), 1e-12);
  }
}

TEST_P(AnyShape, ForceAndStiffnessAreDerivatives) {
  Random random(7);
  for (int trial = 0; trial < 10; ++trial) {
    const Positions x = random.rotation() * rest_ + random.positions(n_, 0.01);
    // Without a shape only distances from the centre count.
    const Forces f = forces_of(set_, x);
    const double h = 1e-6;
    for (int k = 0; k < x.size(); ++k) {
      Positions up = x, down = x;
      up.data()[k] += h;
      down.data()[k] -= h;
      ASSERT_NEAR(f.data()[k], -(set_.energy(up) - set_.energy(down)) / (2.0 * h),
                  1e-6 * f.norm() + 1e-9);
    }
    const Eigen::MatrixXd k = stiffness_of(set_, x);
    EXPECT_LE((k - stiffness_by_differences(set_, x, h)).norm(), 1e-6 * k.norm() + 1e-9);
    const Eigen::MatrixXd projected = stiffness_of(set_, x, Definiteness::kProjected);
    EXPECT_GE(least_eigenvalue(projected), -1e-11 * k.norm() - 1e-15);
    EXPECT_GE(least_eigenvalue(projected - k), -1e-11 * k.norm() - 1e-15);
  }
}

TEST_P(AnyShape, AnyStateIsFiniteAndReturns) {
  Random random(8);
  const Eigen::VectorXd inverse_mass = masses_.cwiseInverse();
  for (const Eigen::Vector3d& squash :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(1, 1, 0),
        Eigen::Vector3d(1, 1, -1), Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1e6, 1, 1),
        Eigen::Vector3d(1e-200, 0, 0)}) {
    Positions x = squash.asDiagonal() * rest_;
    EXPECT_TRUE(forces_of(set_, x).allFinite()) << squash;
    EXPECT_TRUE(stiffness_of(set_, x).allFinite()) << squash;
    EXPECT_TRUE(stiffness_of(set_, x, Definiteness::kProjected).allFinite()) << squash;
    for (int step = 0; step < 100; ++step) {
      set_.reset_multipliers();
      set_.relax(inverse_mass, 1.0, x);
    }
    EXPECT_TRUE(x.allFinite()) << squash;
    EXPECT_LE(set_.energy(x), 1e-12) << squash;
  }
}

TEST(ClusterSet, ScalesFromGramsAndMillimetresUp) {
  // No threshold knows a unit: a cluster of micrometres and micrograms feels like one of metres.
  for (const double length : {1e-6, 1e-3, 1.0, 1e3}) {
    for (const double mass : {1e-9, 1.0, 1e6}) {
      const Positions rest = length * shape("solid");
      const ClusterSet set(rest, Eigen::VectorXd::Constant(5, mass), {all_of(5, 100.0)});
      const Eigen::Matrix3d turn = Random(9).rotation();
      const Positions x = turn * (1.1 * rest);
      const double size = mass * (rest.colwise() - rest.rowwise().mean()).squaredNorm();
      EXPECT_NEAR(set.energy(x) / (0.5 * 100.0 * 0.01 * size), 1.0, 1e-10);
    }
  }
}

TEST(ClusterSet, AKilometreAwayACentimetreKeepsItsShape) {
  const Positions near = 0.05 * shape("solid");
  const Positions rest = near.colwise() + Eigen::Vector3d(1000.0, -1000.0, 500.0);
  const Eigen::VectorXd masses = Eigen::VectorXd::Constant(5, 1e-3);
  const ClusterSet set(rest, masses, {all_of(5, 1e5)});
  const ClusterSet same(near, masses, {all_of(5, 1e5)});
  const Eigen::Matrix3d squash = Eigen::Vector3d(1.2, 0.9, 1.0).asDiagonal();
  const Positions x = (squash * near).colwise() + Eigen::Vector3d(1000.0, -1000.0, 500.0);
  // Positions are rounded to 1e-13 m, the shape is 1e-3 m.
  EXPECT_NEAR(set.energy(x) / same.energy(squash * near), 1.0, 1e-8);
}

TEST(ClusterSet, PinnedParticlesAreBoundaryConditions) {
  const Positions rest = shape("solid");
  Eigen::VectorXd inverse_mass = Eigen::VectorXd::Constant(5, 1e3);
  inverse_mass.head(3).setZero();
  ClusterSet set(rest, Eigen::VectorXd::Constant(5, 1e-3), {all_of(5, 1e5)});
  Positions x = rest;
  x.leftCols(3).colwise() += Eigen::Vector3d(0.2, 0.0, 0.0);
  for (int step = 0; step < 5000; ++step) {
    set.reset_multipliers();
    set.relax(inverse_mass, 1.0, x);
  }
  // The others follow.
  EXPECT_LE((x.colwise() - Eigen::Vector3d(0.2, 0.0, 0.0) - rest).norm(), 1e-9);
}

TEST(ClusterSet, WhatACrushedStateLeavesFreeTheLastRotationDecides) {
  const Positions rest = shape("solid");
  const ClusterSet cold(rest, Eigen::VectorXd::Ones(5), {all_of(5, 1.0)});
  ClusterSet warm(rest, Eigen::VectorXd::Ones(5), {all_of(5, 1.0)});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
  forces_of(warm, turn * rest);
  const Positions middle = rest.rowwise().mean().replicate(1, 5);
  // From a point every rotation is as good: back to the last one.
  const Positions shape = rest - middle;
  EXPECT_LE((forces_of(warm, middle) - turn * shape).norm(), 1e-12);
  EXPECT_LE((forces_of(cold, middle) - shape).norm(), 1e-12);
  warm.reset();
  EXPECT_LE((forces_of(warm, middle) - shape).norm(), 1e-12);
}

TEST(ClusterSet, ResultsDependOnNoHistoryWhereTheStateDecides) {
  Random random(10);
  const Positions rest = shape("solid");
  const ClusterSet fresh(rest, Eigen::VectorXd::Ones(5), {all_of(5, 1.0)});
  const ClusterSet used(rest, Eigen::VectorXd::Ones(5), {all_of(5, 1.0)});
  for (int k = 0; k < 50; ++k) forces_of(used, random.positions(5, 1.0));
  const Positions x = random.rotation() * rest + random.positions(5, 0.02);
  EXPECT_EQ(forces_of(used, x), forces_of(fresh, x));
  EXPECT_EQ(used.energy(x), fresh.energy(x));
}

TEST(ClusterSet, MeltingScalesTheEnergy) {
  Positions rest(3, 10);
  rest << shape("solid"), (shape("flat").colwise() + Eigen::Vector3d(1, 0, 0));
  Cluster second{{5, 6, 7, 8, 9}, 30.0};
  ClusterSet set(rest, Eigen::VectorXd::Ones(10), {all_of(5, 10.0), second});
  const Positions x = rest + Random(2).positions(10, 0.05);
  const double both = set.energy(x);
  set.set_stiffness(1, 0.0);
  const double first = set.energy(x);
  EXPECT_TRUE(forces_of(set, x).rightCols(5).isZero(0.0));
  set.set_stiffness(1, 60.0);
  EXPECT_NEAR(set.energy(x), 2.0 * both - first, 1e-12);
  StateArchive saved;
  set.save(saved);
  set.set_stiffness(1, 5.0);
  set.load(saved);
  EXPECT_NEAR(set.energy(x), 2.0 * both - first, 1e-12);
  expect_refusal([&] { set.set_stiffness(1, -1.0); }, {"cluster 1", "at least 0"});
  expect_refusal([&] { set.set_stiffness(2, 1.0); }, {"cluster 2", "[0, 1]"});
}

TEST(ClusterSet, ForcesFollowWhatChanges) {
  // Each change after a first look at the forces, which may keep what they need for the next.
  const Positions rest = shape("solid");
  const Positions x = 1.1 * rest;
  const Eigen::VectorXd masses = Eigen::VectorXd::Ones(5);
  ClusterSet set(rest, masses, {all_of(5, 10.0)});
  const Forces first = forces_of(set, x);
  set.set_stiffness(0, 20.0);
  EXPECT_LT((forces_of(set, x) - 2.0 * first).norm(), 1e-13 * first.norm());
  StateArchive saved;
  set.save(saved);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(5);
  weights[0] = 0.0;
  set.set_weights(weights, x);
  EXPECT_EQ(forces_of(set, x).col(0).norm(), 0.0) << "melted";
  set.load(saved);
  EXPECT_LT((forces_of(set, x) - 2.0 * first).norm(), 1e-13 * first.norm());
  set.creep(x, 0.0, 1.0);
  EXPECT_LT(forces_of(set, x).norm(), 1e-13 * first.norm()) << "it rests where it is";
}

TEST(ClusterSet, RefusesBadInput) {
  const Positions rest = shape("solid");
  const Eigen::VectorXd masses = Eigen::VectorXd::Ones(5);
  const double inf = std::numeric_limits<double>::infinity();
  const auto refuse = [&](const Cluster& cluster, const std::string& part) {
    expect_refusal(
        [&] {
          ClusterSet(rest, masses, {all_of(5, 1.0), cluster});
        },
        {"cluster 1", part});
  };
  refuse({{}, 1.0}, "no particles");
  refuse({{0, 5}, 1.0}, "particle 5 outside [0, 4]");
  refuse({{-1, 2}, 1.0}, "particle -1 outside");
  refuse({{0, 3, 0}, 1.0}, "particle 0 twice");
  for (const double bad : {-1.0, inf, std::nan("")}) refuse({{0, 1}, bad}, "stiffness is");
  for (const double bad : {0.0, -1.0, inf, std::nan("")}) {
    Eigen::VectorXd wrong = masses;
    wrong[2] = bad;
    expect_refusal([&] { ClusterSet(rest, wrong, {{{0, 2}, 1.0}}); }, {"particle 2", "mass"});
  }
  Positions wrong = rest;
  wrong(1, 4) = inf;
  expect_refusal([&] { ClusterSet(wrong, masses, {all_of(5, 1.0)}); }, {"particle 4", "finite"});
  expect_refusal([&] { ClusterSet(rest, masses.head(4), {all_of(5, 1.0)}); }, {"4 masses", "5"});
}

TEST(ClusterSet, NoClustersAreAnEmptySet) {
  ClusterSet set(shape("solid"), Eigen::VectorXd::Ones(5), {});
  Positions x = shape("solid");
  EXPECT_EQ(set.size(), 0);
  EXPECT_EQ(set.energy(x), 0.0);
  EXPECT_TRUE(forces_of(set, x).isZero(0.0));
  set.relax(Eigen::VectorXd::Ones(5), 0.01, x);
  EXPECT_EQ(x, shape("solid"));
}

}  // namespace
}  // namespace pliant
