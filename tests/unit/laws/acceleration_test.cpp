// What iterations of the CPU and of the GPU are accelerated by.
#include "pliant/laws/acceleration.h"

#include <gtest/gtest.h>

namespace pliant {
namespace {

TEST(Acceleration, AccelerationFollowsItsRecurrences) {
  // ω rises from 2/(2 − ρ²) to its limit 2/(1 + √(1 − ρ²)).
  const double squared = 0.98;
  double omega = chebyshev_factor(squared, 1.0, true);
  EXPECT_DOUBLE_EQ(omega, 2.0 / (2.0 - squared));
  for (int k = 0; k < 200; ++k) omega = chebyshev_factor(squared, omega, false);
  EXPECT_NEAR(omega, 2.0 / (1.0 + std::sqrt(1.0 - squared)), 1e-12);
  // t² − t = t₋²
  double t = 1.0;
  for (int k = 0; k < 20; ++k) {
    const NesterovStep step = nesterov_step(t);
    EXPECT_NEAR(step.next * step.next - step.next, t * t, 1e-9);
    EXPECT_NEAR(step.share, (t - 1.0) / step.next, 1e-15);
    t = step.next;
  }
}

TEST(Acceleration, ChangesThatAreNoiseJudgeNothing) {
  SpectralRadius radius(0.999);
  radius.set(0.99);
  const IterationChange grown = {2.0, false}, noise = {2.0, true}, less = {0.5, false};
  EXPECT_TRUE(grown.has_grown_beyond(1.0));
  EXPECT_FALSE(noise.has_grown_beyond(1.0));
  EXPECT_FALSE(less.has_grown_beyond(1.0));
  EXPECT_TRUE(less.is_best(1.0));
  EXPECT_FALSE(grown.is_best(1.0));
  EXPECT_TRUE(noise.is_best(1.0)) << "later ones are";
  EXPECT_TRUE(grown.lags(radius, 2.0, 100));
  EXPECT_FALSE(noise.lags(radius, 2.0, 100));
}

}  // namespace
}  // namespace pliant
