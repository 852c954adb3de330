#include "pliant/laws/sph_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace pliant {
namespace {

constexpr double kH = 0.7;

/// By the midpoint rule, whose error is below 1e-7 of these smooth integrands.
double integral(double from, double to, const std::function<double(double)>& f) {
  const int n = 20000;
  const double step = (to - from) / n;
  double sum = 0.0;
  for (int k = 0; k < n; ++k) sum += f(from + (k + 0.5) * step);
  return step * sum;
}

double over_space(const std::function<double(double)>& kernel) {
  return integral(0.0, kH, [&](double r) { return 4.0 * M_PI * r * r * kernel(r); });
}

/// ∫ of `kernel` times `factor(z)` over the half space beyond a plane at distance d.
double beyond(double d, const std::function<double(double)>& kernel,
              const std::function<double(double)>& factor) {
  const int n = 2000;
  const double step = (kH - d) / n;
  double sum = 0.0;
  for (int k = 0; k < n; ++k) {
    const double z = d + (k + 0.5) * step;
    const double across = std::sqrt(kH * kH - z * z);
    double ring = 0.0;
    const double width = across / n;
    for (int l = 0; l < n; ++l) {
      const double s = (l + 0.5) * width;
      ring += 2.0 * M_PI * s * kernel(std::sqrt(z * z + s * s));
    }
    sum += factor(z) * ring * width;
  }
  return sum * step;
}

TEST(SphKernels, IntegrateToOne) {
  const SphKernels kernels(kH);
  EXPECT_NEAR(over_space([&](double r) { return kernels.poly6(r * r); }), 1.0, 1e-7);
  EXPECT_NEAR(over_space([&](double r) { return kernels.spiky(r); }), 1.0, 1e-7);
  // ∫ r²/6 ∇²W = ∫ W: so the Laplacian of a quadratic is exact.
  EXPECT_NEAR(over_space([&](double r) { return r * r / 6.0 * kernels.viscosity_laplacian(r); }),
              1.0, 1e-7);
}

TEST(SphKernels, VanishBeyondTheirSupport) {
  const SphKernels kernels(kH);
  for (double r : {kH, 1.1 * kH, 1e6}) {
    EXPECT_EQ(kernels.poly6(r * r), 0.0);
    EXPECT_EQ(kernels.poly6_slope(r * r), 0.0);
    EXPECT_EQ(kernels.spiky(r), 0.0);
    EXPECT_EQ(kernels.spiky_slope(r), 0.0);
    EXPECT_EQ(kernels.viscosity_laplacian(r), 0.0);
    EXPECT_EQ(kernels.poly6_beyond(r), 0.0);
    EXPECT_EQ(kernels.poly6_push_beyond(r), 0.0);
    EXPECT_EQ(kernels.spiky_push_beyond(r), 0.0);
    EXPECT_EQ(kernels.viscosity_drag_beyond(r), 0.0);
  }
}

TEST(SphKernels, SlopesAreDerivatives) {
  const SphKernels kernels(kH);
  const double step = 1e-6;
  for (double r = 0.05 * kH; r < kH; r += 0.1 * kH) {
    const double low = r - step, high = r + step;
    // Central differences: errors of h² W'''/6 and of round-off, both below 1e-6 of the scale.
    EXPECT_NEAR(kernels.poly6_slope(r * r) * r,
                (kernels.poly6(high * high) - kernels.poly6(low * low)) / (2.0 * step),
                1e-6 * kernels.poly6(0.0) / kH);
    EXPECT_NEAR(kernels.spiky_slope(r), (kernels.spiky(high) - kernels.spiky(low)) / (2.0 * step),
                1e-6 * kernels.spiky(0.0) / kH);
  }
}

TEST(SphKernels, WallsAreIntegralsOverHalfSpaces) {
  const SphKernels kernels(kH);
  const auto one = [](double) { return 1.0; };
  for (double d : {0.0, 0.2 * kH, 0.5 * kH, 0.9 * kH}) {
    EXPECT_NEAR(kernels.poly6_beyond(d),
                beyond(
                    d, [&](double r) { return kernels.poly6(r * r); }, one),
                1e-5);
    // The gradient's part along the normal is W' z / r.
    EXPECT_NEAR(
        kernels.spiky_push_beyond(d),
        -beyond(
            d, [&](double r) { return kernels.spiky_slope(r) / r; }, [](double z) { return z; }),
        1e-4 / kH);
    EXPECT_NEAR(
        kernels.poly6_push_beyond(d),
        -beyond(
            d, [&](double r) { return kernels.poly6_slope(r * r); }, [](double z) { return z; }),
        1e-4 / kH);
    if (d == 0.0) continue;
    EXPECT_NEAR(kernels.viscosity_drag_beyond(d),
                beyond(
                    d, [&](double r) { return kernels.viscosity_laplacian(r); },
                    [&](double z) { return z / d; }),
                1e-4 / (kH * d));
  }
  EXPECT_DOUBLE_EQ(kernels.poly6_beyond(0.0), 0.5);
}

}  // namespace
}  // namespace pliant
