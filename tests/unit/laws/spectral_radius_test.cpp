#include "pliant/laws/spectral_radius.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pliant {
namespace {

/// By how much `n` iterations of the recurrence for `assumed` change an error whose plain iteration
/// multiplies it by `radius`: e <- omega (radius e - e_before) + e_before.
double reduction(double assumed, double radius, int n) {
  double before = 1.0, error = radius, omega = 1.0;
  for (int k = 1; k < n; ++k) {
    const double rho2 = assumed * assumed;
    omega = k == 1 ? 2.0 / (2.0 - rho2) : 4.0 / (4.0 - rho2 * omega);
    const double next = omega * (radius * error - before) + before;
    before = error;
    error = next;
  }
  return error;
}

TEST(SpectralRadius, IsRecoveredExactlyFromAnErrorBeyondIt) {
  for (const double assumed : {0.3, 0.9, 0.99, 0.999}) {
    for (const double share : {0.01, 0.3, 0.9}) {
      const double radius = assumed + share * (1.0 - assumed);
      for (const int n : {4, 10, 40}) {
        SpectralRadius estimate(0.99999);
        estimate.set(assumed);
        estimate.raise(reduction(assumed, radius, n), n);
        // The ratio's round-off of n epsilon goes through cosh(acosh(.)/n), whose slope in the
        // logarithm is tanh(.)/n < 1.
        EXPECT_NEAR(estimate.value(), radius, 40 * 2.3e-16 * n) << assumed << " " << n;
      }
    }
  }
}

TEST(SpectralRadius, IsRecoveredFromThousandsOfIterations) {
  // T_n(1/ρ) of so many is no double any more.
  const int n = 20000;
  const double assumed = 0.98, radius = 0.9995;
  // T_n(radius/ρ) / T_n(1/ρ), of which the halves of cosh's other exponential are long gone.
  const double ratio = std::exp(n * (std::acosh(radius / assumed) - std::acosh(1.0 / assumed)));
  ASSERT_GT(ratio, 0.0);
  SpectralRadius estimate(0.99999);
  estimate.set(assumed);
  estimate.raise(ratio, n);
  EXPECT_NEAR(estimate.value(), radius, 1e-13);
}

TEST(SpectralRadius, ThatIsLargeEnoughStays) {
  for (const double radius : {0.0, 0.2, 0.5, 0.8999}) {
    for (const int n : {1, 4, 17}) {
      SpectralRadius estimate(0.99999);
      estimate.set(0.9);
      estimate.raise(std::abs(reduction(0.9, radius, n)), n);
      EXPECT_DOUBLE_EQ(estimate.value(), 0.9) << radius << " " << n;
    }
  }
}

TEST(SpectralRadius, NeverPassesItsBound) {
  SpectralRadius estimate(0.95);
  estimate.set(2.0);
  EXPECT_EQ(estimate.value(), 0.95);
  estimate.set(-1.0);
  EXPECT_EQ(estimate.value(), 0.0);
  estimate.set(0.9);
  estimate.raise(1.5, 10);
  EXPECT_EQ(estimate.value(), 0.95);
}

TEST(SpectralRadius, LoweringDoublesTheDistanceFromOne) {
  SpectralRadius estimate(0.99999);
  estimate.set(0.99);
  estimate.lower();
  EXPECT_NEAR(estimate.value(), 0.98, 1e-15);
  for (int k = 0; k < 10; ++k) estimate.lower();
  // Ends as plain Jacobi, never below.
  EXPECT_EQ(estimate.value(), 0.0);
}

TEST(SpectralRadius, NonsenseTeachesNothing) {
  SpectralRadius estimate(0.99999);
  estimate.set(0.9);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double ratio : {0.0, -1.0, kInfinity, -kInfinity, std::nan("")}) {
    estimate.raise(ratio, 10);
    EXPECT_EQ(estimate.value(), 0.9) << ratio;
  }
  estimate.raise(0.5, 0);
  EXPECT_EQ(estimate.value(), 0.9);
  SpectralRadius none(0.99999);
  none.raise(0.5, 10);
  EXPECT_EQ(none.value(), 0.0);
}

}  // namespace
}  // namespace pliant
