// Shape matching as the paper solves it, with the momentum, contact and limits of all solvers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "pliant/core/parallel/parallel.h"
#include "support/expect_refusal.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

const std::vector<std::string> kSweeps = {"jacobi", "weighted_jacobi", "gauss_seidel", "hybrid"};

ViscoelasticModel::Material clustered() {
  ViscoelasticModel::Material material;
  material.solid.cluster_fraction = 1.0;
  return material;
}

/// A bar of 10 x 3 x 3 particles.
BodyGeometry bar() { return lattice_body({10, 3, 3}, 0.01); }

TEST(ShapeMatching, AFreeBarKeepsItsMomentum) {
  for (const std::string& sweep : kSweeps) {
    ParticleWorld t(bar(), clustered(), 0.01);
    t.start("shape_matching", {{"sweep", sweep}, {"iterations", "3"}});
    for (int i = 0; i < t.particles().size(); ++i) {
      const double along = t.particles().x(0, i) / 0.05 - 1.0;
      t.particles().v.col(i) = Eigen::Vector3d(0.3, 0.5 * along, 1.5 * along * along);
    }
    const Eigen::Vector3d momentum = t.particles().momentum();
    ASSERT_EQ(t.run_until(0.1), "");
    EXPECT_LT((t.particles().momentum() - momentum).norm(), 1e-12 * momentum.norm()) << sweep;
    EXPECT_GT(t.body().report.residual, 0.0) << "the clusters' strain is told";
  }
}

TEST(ShapeMatching, WhatTurnsFreelyTurnsOn) {
  // Angular momentum as with the other solvers of implicit steps: what they lose, it loses.
  ParticleWorld t(bar(), clustered(), 0.002);
  t.start("shape_matching", {{"sweep", "jacobi"}, {"iterations", "20"}});
  const Eigen::Vector3d middle = t.particles().x.rowwise().mean();
  for (int i = 0; i < t.particles().size(); ++i) {
    t.particles().v.col(i) = Eigen::Vector3d(0, 0, 5.0).cross(t.particles().x.col(i) - middle);
  }
  const Eigen::Vector3d before = t.particles().angular_momentum();
  ASSERT_EQ(t.run_until(0.1), "");
  EXPECT_NEAR(t.particles().angular_momentum().z() / before.z(), 1.0, 0.02);
}

/// Iterations of a step to a mean strain of 2e-4, in all of 20 steps of a bar under its weight.
int iterations_of(const std::string& sweep) {
  ParticleWorld t(bar(), clustered(), 0.01);
  for (int i = 0; i < t.particles().size(); ++i) {
    if (t.particles().x(0, i) < 0.02) t.particles().fix(i);
  }
  t.add_effect("gravity");
  t.start("shape_matching", {{"sweep", sweep}, {"iterations", "3000"}, {"tolerance", "2e-4"}});
  int sum = 0;
  for (int k = 0; k < 20; ++k) {
    EXPECT_TRUE(t.world().step());
    EXPECT_LE(t.body().report.residual, 2e-4) << sweep;
    sum += t.body().report.iterations;
  }
  return sum;
}

TEST(ShapeMatching, WeightsAndOrderSaveIterations) {
  const int jacobi = iterations_of("jacobi"), weighted = iterations_of("weighted_jacobi"),
            hybrid = iterations_of("hybrid"), gauss_seidel = iterations_of("gauss_seidel");
  EXPECT_LT(weighted, 0.8 * jacobi) << jacobi;
  EXPECT_LT(hybrid, 0.5 * jacobi) << jacobi;
  EXPECT_LT(gauss_seidel, hybrid);
}

TEST(ShapeMatching, AStepTakesTheShareAlphaOfTheDisplacement) {
  // Bent at rest without forces: the prediction is the start.
  Positions ends[3];
  const char* shares[] = {"0", "0.25", "1"};
  Positions start;
  for (int k = 0; k < 3; ++k) {
    ParticleWorld t(bar(), clustered(), 0.01);
    t.start("shape_matching", {{"alpha", shares[k]}, {"iterations", "4"}});
    for (int i = 0; i < t.particles().size(); ++i) {
      t.particles().x(2, i) += 3.0 * t.particles().x(0, i) * t.particles().x(0, i);
    }
    start = t.particles().x;
    ASSERT_TRUE(t.world().step());
    ends[k] = t.particles().x;
  }
  EXPECT_LT((ends[0] - start).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_GT((ends[2] - start).cwiseAbs().maxCoeff(), 1e-4);
  // But for the little turn that keeps the angular momentum.
  const double off = (ends[1] - start - 0.25 * (ends[2] - start)).norm();
  EXPECT_LT(off, 0.02 * (ends[2] - start).norm());
}

TEST(ShapeMatching, ALiquidFallsAndHalfALiquidIsPulledByHalf) {
  for (const double beta : {1.0, 0.5}) {
    ViscoelasticModel::Material material = clustered();
    material.beta = beta;
    ParticleWorld t(bar(), material, 0.001);
    t.add_effect("gravity");
    t.start("shape_matching", {{"iterations", "3"}});
    ASSERT_EQ(t.run_until(0.02), "");
    EXPECT_NEAR(t.particles().v.row(2).mean(), -9.81 * 0.02, 1e-6) << beta;
  }
}

TEST(ShapeMatching, OnAFloorItRestsAndTheFloorCarriesIt) {
  for (const std::string& sweep : kSweeps) {
    ParticleWorld t(lattice_body({5, 4, 3}, 0.01), clustered(), 0.005);
    t.add_box({0.3, 0.3, 0.05}, {0.0, 0.0, -0.03});
    t.add_effect("gravity");
    t.add_effect("contact", {{"thickness", "0.002"}});
    t.add_effect("damping", {{"rate", "5"}});
    t.start("shape_matching", {{"sweep", sweep}, {"iterations", "10"}});
    ASSERT_EQ(t.run_until(1.0), "");
    const double weight = 9.81 * t.particles().mass.sum();
    EXPECT_NEAR(-t.world().reactions()[0].force.z() / weight, 1.0, 0.02) << sweep;
    EXPECT_LT(t.particles().v.cwiseAbs().maxCoeff(), 2e-3) << sweep;
  }
}

TEST(ShapeMatching, SaysOnceThatItKnowsNoModulus) {
  ParticleWorld t(bar(), clustered(), 0.01);
  t.start("shape_matching", {});
  int told = 0;
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(t.world().step());
    for (const std::string& warning : t.body().report.warnings) {
      told += warning.find("modulus_ignored") != std::string::npos ? 1 : 0;
    }
  }
  EXPECT_EQ(told, 1);
}

TEST(ShapeMatching, SameBitsForAnyNumberOfThreads) {
  for (const std::string& sweep : kSweeps) {
    Positions first;
    for (const int count : {1, 3}) {
      set_threads(count);
      ParticleWorld t(lattice_body({12, 6, 6}, 0.01), clustered(), 0.01);
      t.add_effect("gravity");
      t.start("shape_matching", {{"sweep", sweep}, {"iterations", "5"}});
      t.particles().x.row(2) += t.particles().x.row(0).cwiseAbs2();
      ASSERT_EQ(t.run_until(0.03), "");
      if (first.size() == 0) first = t.particles().x;
      EXPECT_TRUE(t.particles().x == first) << sweep;
    }
  }
  set_threads(1);
}

TEST(ShapeMatching, IsForParticlesAndTheOldNameSaysWhatBecameOfIt) {
  expect_refusal([] { all_solvers().find_for("shape_matching", "cloth"); },
                 {"does not work for model 'cloth'"});
  expect_refusal([] { find_solver("weighted_jacobi"); },
                 {"line_search_jacobi", "shape_matching", "sweep: weighted_jacobi"});
  EXPECT_NO_THROW(find_solver("line_search_jacobi"));
}

}  // namespace
}  // namespace pliant
