#include "pliant/elements/solids/volume_projection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "support/random.h"

namespace pliant {
namespace {

/// σ₀ ≥ σ₁ ≥ |σ₂| of a random sign.
Eigen::Vector3d random_stretches(Random& random, double least, double most) {
  Eigen::Vector3d s;
  for (double& each : s) each = std::exp(random(std::log(least), std::log(most)));
  std::sort(s.data(), s.data() + 3, std::greater<double>());
  if (random(0.0, 1.0) < 0.3) s[2] = -s[2];
  return s;
}

double squared_distance(const Eigen::Vector3d& sigma, double p0, double p1, double volume) {
  return (sigma - Eigen::Vector3d(p0, p1, volume / (p0 * p1))).squaredNorm();
}

/// By search over p₀ and p₁ of both signs, the step halved as it closes in.
double least_squared_distance(const Eigen::Vector3d& sigma, double volume) {
  double best = 1e300;
  for (const double sign0 : {1.0, -1.0}) {
    for (const double sign1 : {1.0, -1.0}) {
      double least = 1e300, at0 = 0.0, at1 = 0.0;
      const auto look = [&](double log0, double log1) {
        const double d =
            squared_distance(sigma, sign0 * std::exp(log0), sign1 * std::exp(log1), volume);
        if (d < least) least = d, at0 = log0, at1 = log1;
      };
      for (double a = -6.0; a <= 6.0; a += 0.1) {
        for (double b = -6.0; b <= 6.0; b += 0.1) look(a, b);
      }
      for (double step = 0.1; step > 1e-9; step *= 0.7) {
        const double a = at0, b = at1;
        for (int k = -2; k <= 2; ++k) {
          for (int l = -2; l <= 2; ++l) look(a + k * step, b + l * step);
        }
      }
      best = std::min(best, least);
    }
  }
  return best;
}

TEST(VolumeProjection, IsTheNearestPoint) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d sigma = random_stretches(random, 0.05, 8.0);
    const double volume = trial % 2 == 0 ? 1.0 : random(0.3, 3.0);
    const VolumeProjection nearest = project_to_volume(sigma, volume);
    ASSERT_NEAR(nearest.p.prod(), volume, 1e-12 * volume) << sigma.transpose();
    ASSERT_LE((nearest.p - sigma - nearest.mu * nearest.p.cwiseInverse()).norm(),
              1e-12 * (sigma.norm() + nearest.p.norm()));
    ASSERT_NEAR(nearest.squared_distance(), (nearest.p - sigma).squaredNorm(),
                1e-12 * (1.0 + sigma.squaredNorm()));
    const double brute = least_squared_distance(sigma, volume);
    ASSERT_NEAR(nearest.squared_distance(), brute, 1e-9 * (1.0 + brute))
        << sigma.transpose() << " -> " << volume;
  }
}

TEST(VolumeProjection, NearRestItKeepsItsDigits) {
  // p - σ = μ/p; for σ = 1 + ε the first order is -tr(ε)/3.
  for (const double e : {1e-4, 1e-8, 1e-12}) {
    const Eigen::Vector3d sigma(1.0 + e, 1.0, 1.0 - 2.0 * e);
    const VolumeProjection nearest = project_to_volume(sigma, 1.0);
    EXPECT_NEAR(nearest.mu, e / 3.0, 10.0 * e * e + 1e-16);
  }
  const VolumeProjection rest = project_to_volume(Eigen::Vector3d::Ones(), 1.0);
  EXPECT_EQ(rest.mu, 0.0);
  EXPECT_EQ(rest.p, Eigen::Vector3d::Ones());
}

TEST(VolumeProjection, FlattensWhatIsFarTooLarge) {
  const VolumeProjection shrunk = project_to_volume(Eigen::Vector3d::Constant(1.9), 1.0);
  EXPECT_LE((shrunk.p - Eigen::Vector3d::Ones()).norm(), 1e-12);
  const VolumeProjection flat = project_to_volume(Eigen::Vector3d::Constant(2.1), 1.0);
  EXPECT_LT(flat.p[2], 0.5);
  EXPECT_GT(flat.p[1], 1.5);
}

TEST(VolumeProjection, SlopeIsTheDerivative) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d sigma = random_stretches(random, 0.3, 2.0);
    const VolumeProjection nearest = project_to_volume(sigma, 1.0);
    const StretchSlope slope = volume_slope(sigma, nearest);
    const double h = 1e-6;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
      const VolumeProjection up = project_to_volume(sigma + step, 1.0);
      const VolumeProjection down = project_to_volume(sigma - step, 1.0);
      ASSERT_LE(((up.p - down.p) / (2.0 * h) - slope.stretch.col(k)).norm(),
                1e-6 * slope.stretch.norm())
          << sigma.transpose();
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      ASSERT_NEAR(slope.flip[k] * (sigma[i] - sigma[j]), nearest.p[i] - nearest.p[j], 1e-10);
      ASSERT_NEAR(slope.twist[k] * (sigma[i] + sigma[j]), nearest.p[i] + nearest.p[j], 1e-10);
    }
  }
}

TEST(VolumeProjection, AnySizeGivesAFiniteAnswer) {
  for (const double a : {1e-12, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e12}) {
    for (const double b : {0.0, 1e-12, 1e-3, 0.5, 1.0}) {
      for (const double c : {-1.0, -0.5, -1e-12, 0.0, 1e-12, 0.5, 1.0}) {
        const Eigen::Vector3d sigma(a, a * b, a * b * c);
        for (const double volume : {1e-6, 1.0, 1e6}) {
          const VolumeProjection nearest = project_to_volume(sigma, volume);
          ASSERT_TRUE(nearest.p.allFinite()) << sigma.transpose() << " -> " << volume;
          ASSERT_GT(nearest.p.minCoeff(), 0.0) << sigma.transpose() << " -> " << volume;
          ASSERT_NEAR(nearest.p.prod() / volume, 1.0, 1e-9) << sigma.transpose() << " " << volume;
          const StretchSlope slope = volume_slope(sigma, nearest);
          ASSERT_TRUE(slope.stretch.allFinite() && slope.flip.allFinite() &&
                      slope.twist.allFinite());
        }
      }
    }
  }
}

}  // namespace
}  // namespace pliant
