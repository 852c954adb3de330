// Bodies of particles that touch each other and themselves.
#include <gtest/gtest.h>

#include <cmath>

#include "pliant/effects/self_contact/self_contact.h"
#include "support/worlds/particle_bodies.h"

namespace pliant::particle_contact_test {
namespace {

constexpr double kSpacing = 0.01;

ViscoelasticModel::Material soft(double young) {
  ViscoelasticModel::Material material;
  material.solid.young = young;
  // Pressure alone shall hold nothing apart.
  material.liquid.sound_speed = 0.1;
  return material;
}

/// Two arms along x, 6 spacings apart, joined by a back: one body.
BodyGeometry fork() {
  BodyGeometry geometry;
  std::vector<Eigen::Vector3d> points;
  for (int x = 0; x < 14; ++x) {
    for (int y = 0; y < 3; ++y) {
      for (int z = 0; z < 12; ++z) {
        const bool is_arm = z < 3 || z >= 9;
        if (x < 3 || is_arm) points.emplace_back(kSpacing * Eigen::Vector3d(x, y, z));
      }
    }
  }
  geometry.interior_points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    geometry.interior_points.col(static_cast<Eigen::Index>(k)) = points[k];
  }
  geometry.volume = std::pow(kSpacing, 3.0) * static_cast<double>(points.size());
  return geometry;
}

/// How far the particles of the upper arm are above those of the lower one that lie below them, at
/// the least, in spacings.
double least_gap(const Positions& rest, const Positions& x) {
  double least = 1e9;
  for (int i = 0; i < x.cols(); ++i) {
    if (rest(0, i) < 5.0 * kSpacing || rest(2, i) < 8.5 * kSpacing) continue;
    for (int j = 0; j < x.cols(); ++j) {
      if (rest(0, j) < 5.0 * kSpacing || rest(2, j) > 2.5 * kSpacing) continue;
      const Eigen::Vector3d apart = x.col(i) - x.col(j);
      if (apart.head<2>().norm() < 0.5 * kSpacing) least = std::min(least, apart.z() / kSpacing);
    }
  }
  return least;
}

/// The least gap while the arms are thrown at each other.
double least_gap_of_clap(const std::string& solver, bool touches) {
  ParticleWorld t(fork(), soft(1e4), 0.01);
  if (touches) t.add_effect("self_contact", {{"friction", "0.3"}});
  t.start(solver, {{"iterations", "40"}});
  const Positions rest = t.particles().x;
  for (int i = 0; i < t.particles().size(); ++i) {
    const double out = std::max(0.0, rest(0, i) / kSpacing - 3.0) / 10.0;
    t.particles().v(2, i) = (rest(2, i) > 5.5 * kSpacing ? -3.0 : 3.0) * out;
  }
  double least = 1e9;
  for (int k = 0; k < 30; ++k) {
    EXPECT_TRUE(t.world().step()) << t.world().failure();
    least = std::min(least, least_gap(rest, t.particles().x));
  }
  return least;
}

TEST(ParticleContact, TwoPartsOfOneBodyDoNotPassThroughEachOther) {
  EXPECT_LT(least_gap_of_clap("chebyshev", false), 0.0) << "they meet";
  for (const std::string solver : {"jacobi", "gauss_seidel", "chebyshev", "xpbd", "direct"}) {
    // Balls of a spacing, half of it beside each other: 0.87, less a tenth that sweeps may leave.
    EXPECT_GT(least_gap_of_clap(solver, true), 0.77) << solver;
  }
}

TEST(ParticleContact, TwoBodiesThatMeetFastKeepApartAndKeepMomentum) {
  for (const double speed : {1.0, 4.0}) {
    ParticleWorld t(lattice_body({6, 6, 4}, kSpacing), soft(3e4), 0.005);
    // A little beside, so that particles meet gaps between particles.
    t.add(lattice_body({5, 5, 4}, kSpacing), soft(3e4), {0.007, 0.004, 0.055}, {0, 0, -speed});
    t.add_effect("self_contact");
    t.start("chebyshev", {{"iterations", "40"}});
    const int first = 6 * 6 * 4;
    const Eigen::Vector3d before = t.particles().momentum();
    for (int k = 0; k < 60; ++k) {
      ASSERT_TRUE(t.world().step()) << t.world().failure();
      const Positions& x = t.particles().x;
      const double lower = x.leftCols(first).row(2).mean();
      const double upper = x.rightCols(x.cols() - first).row(2).mean();
      // Each is 4 spacings high: crushed to half of that at the most.
      ASSERT_GT(upper - lower, 2.0 * kSpacing) << speed << " m/s, step " << k;
    }
    EXPECT_LT((t.particles().momentum() - before).norm(), 1e-10 * before.norm());
    EXPECT_GT(t.particles().v.rightCols(100).row(2).mean(),
              t.particles().v.leftCols(first).row(2).mean())
        << "they part again";
  }
}

TEST(ParticleContact, ABodyAtRestDoesNotTouchItself) {
  // Neither squeezed nor bent a little: what binds its particles is all that they feel.
  ParticleWorld t(sampled_box({0.08, 0.06, 0.05}, kSpacing), soft(1e4), 0.01);
  t.add_effect("self_contact");
  t.start("chebyshev", {{"iterations", "20"}});
  t.particles().x.row(0) *= 0.8;
  t.particles().x.row(2) += 2.0 * t.particles().x.row(0).cwiseAbs2();
  for (int k = 0; k < 20; ++k) {
    ASSERT_TRUE(t.world().step());
    EXPECT_EQ(t.body().report.contacts, 0);
  }
}

TEST(ParticleContact, WhatFrozeTogetherIsBoundAndWhatMeltedApartTouches) {
  ParticleWorld t(fork(), soft(1e4), 0.01);
  t.add_effect("self_contact");
  t.start("chebyshev", {{"iterations", "20"}});
  const BlendedClusters& solid = t.model().system().solid();
  const auto nearest_to = [&](const Eigen::Vector3d& place) {
    Eigen::Index index = 0;
    (t.particles().x.colwise() - kSpacing * place).colwise().squaredNorm().minCoeff(&index);
    return static_cast<int>(index);
  };
  const int low = nearest_to({13, 1, 2}), high = nearest_to({13, 1, 9});
  const int beside = nearest_to({12, 1, 2});
  EXPECT_TRUE(solid.are_bound(low, beside));
  EXPECT_FALSE(solid.are_bound(low, high));
  for (int i : {low, high}) t.model().set_beta(i, 1.0);
  ASSERT_EQ(t.run_until(0.03), "");
  EXPECT_FALSE(solid.are_bound(low, high));
  // They freeze where they have met.
  t.particles().x.col(high) = t.particles().x.col(low) + Eigen::Vector3d(0, 0, kSpacing);
  t.particles().v.setZero();
  for (int i : {low, high}) t.model().set_beta(i, 0.0);
  ASSERT_EQ(t.run_until(0.06), "");
  EXPECT_TRUE(solid.are_bound(low, high));
}

}  // namespace
}  // namespace pliant::particle_contact_test
