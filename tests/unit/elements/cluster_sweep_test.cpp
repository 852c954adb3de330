// The paper's iterations over clusters against their formulas, eqs. 2.31 to 2.35.
#include "pliant/elements/clusters/cluster_sweep.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace pliant {
namespace {

/// Twelve particles of different masses out of place, in clusters that share some of them.
class ClusterSweeps : public testing::Test {
 protected:
  static constexpr int kSwept = 12;
  Random random_{11};
  Positions rest_ = random_.positions(kSwept, 0.1);
  Positions x_ = random_.rotation() * rest_ + random_.positions(kSwept, 0.02);
  Eigen::VectorXd masses_ = Eigen::VectorXd::LinSpaced(kSwept, 1e-3, 3e-3);
  Eigen::VectorXd inverse_mass_ = masses_.cwiseInverse();
  ClusterSet set_{rest_,
                  masses_,
                  {{{0, 1, 2, 3, 4, 5}, 1e5},
                   {{3, 4, 5, 6, 7}, 1e5},
                   {{6, 7, 8, 9}, 1e3},
                   {{1, 8, 9, 10}, 1e5},
                   {{0, 10}, 1e5}}};

  Positions after(ClusterOrder order, const Positions& x) {
    ClusterSweep sweep(order);
    sweep.prepare(set_, inverse_mass_);
    Positions moved = x;
    sweep.iterate(set_, moved);
    return moved;
  }
  /// Where a cluster wants a member: R (x⁰ − x⁰_cm) + x_cm.
  Eigen::Vector3d goal(int cluster, int member, const Positions& x) const {
    const ClusterSet::Motion motion = set_.fit(cluster, x);
    return motion.topLeftCorner<3, 3>() * set_.shapes().member(member).rest +
           motion.topRightCorner<3, 1>();
  }
  /// The mean of the goals of some clusters, with weights 1 or Σ |g − x|, written out.
  Positions mean_of(const std::vector<int>& clusters, bool by_deformation, const Positions& x) {
    Positions sum = Positions::Zero(3, kSwept);
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(kSwept);
    for (const int c : clusters) {
      const ClusterShapes::Shape& shape = set_.shapes().shape(c);
      double d = 0.0;
      for (int k = shape.begin; k < shape.end; ++k) {
        d += (goal(c, k, x) - x.col(set_.shapes().member(k).particle)).norm();
      }
      const double weight = by_deformation ? d : 1.0;
      for (int k = shape.begin; k < shape.end; ++k) {
        const int i = set_.shapes().member(k).particle;
        sum.col(i) += weight * goal(c, k, x);
        weights[i] += weight;
      }
    }
    Positions mean = x;
    for (int i = 0; i < kSwept; ++i) {
      if (weights[i] > 0.0 && inverse_mass_[i] > 0.0) mean.col(i) = sum.col(i) / weights[i];
    }
    return mean;
  }
};

constexpr double kGoalRoundOff = 1e-14;  // of 0.2 m

TEST_F(ClusterSweeps, JacobiTakesTheMeanOfAllGoals) {
  const Positions expected = mean_of({0, 1, 2, 3, 4}, false, x_);
  EXPECT_LT((after({1, false}, x_) - expected).cwiseAbs().maxCoeff(), kGoalRoundOff);
  EXPECT_GT((expected - x_).norm(), 0.01);
}

TEST_F(ClusterSweeps, DeformedClustersCountByTheirDeformation) {
  const Positions expected = mean_of({0, 1, 2, 3, 4}, true, x_);
  const Positions found = after({1, true}, x_);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kGoalRoundOff);
  EXPECT_GT((found - after({1, false}, x_)).cwiseAbs().maxCoeff(), 1e-4) << "weights matter";
}

TEST_F(ClusterSweeps, GaussSeidelTakesOneClusterAfterTheOther) {
  Positions expected = x_;
  for (const int c : set_.shapes().order()) expected = mean_of({c}, false, expected);
  EXPECT_LT((after({0, false}, x_) - expected).cwiseAbs().maxCoeff(), kGoalRoundOff);
}

TEST_F(ClusterSweeps, TheHybridTakesGroupsAfterEachOther) {
  const std::vector<int>& order = set_.shapes().order();
  // Two groups: two clusters, then three.
  Positions expected = mean_of({order[0], order[1]}, false, x_);
  expected = mean_of({order[2], order[3], order[4]}, false, expected);
  EXPECT_LT((after({2, false}, x_) - expected).cwiseAbs().maxCoeff(), kGoalRoundOff);
  // With more groups than clusters each is alone, as with Gauss-Seidel.
  EXPECT_LT((after({100, false}, x_) - after({0, false}, x_)).cwiseAbs().maxCoeff(), kGoalRoundOff);
}

TEST_F(ClusterSweeps, PinnedAndLooseParticlesStay) {
  inverse_mass_[4] = 0.0;
  for (const ClusterOrder order : {ClusterOrder{1, false}, {1, true}, {0, false}, {3, false}}) {
    const Positions moved = after(order, x_);
    EXPECT_EQ(moved.col(4), x_.col(4)) << "it is pinned";
    EXPECT_EQ(moved.col(11), x_.col(11)) << "it is in no cluster";
    EXPECT_NE(moved.col(5), x_.col(5));
  }
}

TEST_F(ClusterSweeps, AtRestNothingMovesAndTheStrainIsNone) {
  const Positions x = (random_.rotation() * rest_).colwise() + Eigen::Vector3d(1, 2, 3);
  for (const ClusterOrder order : {ClusterOrder{1, false}, {1, true}, {0, false}, {3, false}}) {
    ClusterSweep sweep(order);
    sweep.prepare(set_, inverse_mass_);
    EXPECT_LT((after(order, x) - x).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT(sweep.strain(set_, x), 1e-13);
    EXPECT_GT(sweep.strain(set_, x_), 0.05);
  }
}

TEST_F(ClusterSweeps, TheStrainIsTheSameInAnyUnit) {
  ClusterSet larger(1e3 * rest_, masses_, {{{0, 1, 2, 3, 4, 5}, 1e5}});
  ClusterSet own(rest_, masses_, {{{0, 1, 2, 3, 4, 5}, 1e5}});
  ClusterSweep sweep({1, true});
  sweep.prepare(own, inverse_mass_);
  const double strain = sweep.strain(own, x_);
  sweep.prepare(larger, inverse_mass_);
  EXPECT_NEAR(sweep.strain(larger, 1e3 * x_) / strain, 1.0, 1e-12);
}

TEST_F(ClusterSweeps, WhatMeltedIsInNoClusterAnyMore) {
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(kSwept);
  weights[3] = 0.0;
  weights[5] = 0.25;
  set_.set_weights(weights, x_);
  ClusterSweep sweep({1, false});
  sweep.prepare(set_, inverse_mass_);
  Positions moved = x_;
  sweep.iterate(set_, moved);
  EXPECT_EQ(moved.col(3), x_.col(3));
  EXPECT_EQ(sweep.parts()[3], 0.0);
  EXPECT_EQ(sweep.parts()[5], 0.25);
  EXPECT_EQ(sweep.parts()[4], 1.0);
}

TEST_F(ClusterSweeps, ACrushedClusterStaysFinite) {
  Positions x = x_;
  x.setConstant(0.5);
  for (const ClusterOrder order : {ClusterOrder{1, false}, {1, true}, {0, false}, {3, false}}) {
    EXPECT_TRUE(after(order, x).allFinite());
  }
}

}  // namespace
}  // namespace pliant
