#include "pliant/models/viscoelastic/interior_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "pliant/core/system/neighbor_lists.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/laws/sph_kernels.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr double kSpacing = 0.05;

InteriorSamples box_samples() {
  return sample_interior(Box(Eigen::Vector3d(1.0, 0.8, 0.6)).surface(), kSpacing);
}

TEST(InteriorSamples, FillTheBodyAndNothingElse) {
  const InteriorSamples samples = box_samples();
  EXPECT_NEAR(samples.volume, 0.48, 1e-12);
  const double expected = samples.volume / std::pow(kSpacing, 3);
  EXPECT_NEAR(static_cast<double>(samples.points.cols()), expected, 0.02 * expected);
  const Eigen::Vector3d half(0.5, 0.4, 0.3);
  EXPECT_TRUE(((half - samples.points.rowwise().maxCoeff()).array() > 0.0).all());
  EXPECT_TRUE(((half + samples.points.rowwise().minCoeff()).array() > 0.0).all());
}

TEST(InteriorSamples, AreBlueNoise) {
  const InteriorSamples samples = box_samples();
  const Eigen::Matrix3Xd& x = samples.points;
  const auto n = static_cast<double>(x.cols());
  const double spacing = std::cbrt(samples.volume / n);
  NeighborLists lists;
  lists.build(x, 2.0 * spacing);
  double nearest = 1.0;
  for (int k = 0; k < lists.size(); ++k) {
    for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
      nearest = std::min(nearest, (x.col(lists.order()[static_cast<std::size_t>(k)]) -
                                   x.col(lists.order()[static_cast<std::size_t>(*j)]))
                                      .norm());
    }
  }
  // Poisson-disk samples of random darts reach 0.75 at the most for their density.
  EXPECT_GT(nearest, 0.75 * spacing);
  // The structure factor S(k) = |Σ exp(i k x)|² / n over waves that fit the box: 1 for random
  // points, small for blue noise up to a wavelength of a few spacings.
  double power = 0.0;
  int waves = 0;
  for (int a = 0; a <= 4; ++a) {
    for (int b = 0; b <= 4; ++b) {
      for (int c = 0; c <= 3; ++c) {
        if (a + b + c == 0) continue;
        const Eigen::Vector3d k = 2.0 * M_PI * Eigen::Vector3d(a / 1.0, b / 0.8, c / 0.6);
        std::complex<double> sum = 0.0;
        for (const auto p : x.colwise()) sum += std::exp(std::complex<double>(0.0, k.dot(p)));
        power += std::norm(sum) / n;
        ++waves;
      }
    }
  }
  EXPECT_LT(power / waves, 0.1);
}

TEST(InteriorSamples, KernelSumsAreWhatTheLiquidTakesThemFor) {
  const InteriorSamples samples = sample_interior(Box(Eigen::Vector3d(1, 1, 1)).surface(), 0.05);
  const Eigen::Matrix3Xd& x = samples.points;
  const double volume = samples.volume / static_cast<double>(x.cols());
  const SphKernels kernels(2.0 * std::cbrt(volume));
  NeighborLists lists;
  lists.build(x, kernels.support());
  double filling = 0.0, laplacian = 0.0;
  int count = 0;
  for (int k = 0; k < lists.size(); ++k) {
    const auto p = x.col(lists.order()[static_cast<std::size_t>(k)]);
    if (p.cwiseAbs().maxCoeff() > 0.5 - kernels.support()) continue;
    filling += volume * kernels.spiky(0.0);
    for (const int* j = lists.begin(k); j != lists.end(k); ++j) {
      const double r = (p - x.col(lists.order()[static_cast<std::size_t>(*j)])).norm();
      filling += volume * kernels.spiky(r);
      laplacian += volume * r * r / 6.0 * kernels.viscosity_laplacian(r);
    }
    ++count;
  }
  ASSERT_GT(count, 1000);
  // Samples are a little more even than liquid at rest.
  EXPECT_NEAR(filling / count, 1.233, 0.003);
  EXPECT_LT(filling / count, kSphBulk);
  EXPECT_NEAR(laplacian / count, kSphLaplacian, 0.01);
}

TEST(InteriorSamples, AreTheSameEachTimeAndScaleWithTheBody) {
  const InteriorSamples first = sample_interior(Sphere(0.1).surface(), 0.02);
  EXPECT_TRUE(sample_interior(Sphere(0.1).surface(), 0.02).points == first.points);
  const InteriorSamples large = sample_interior(Sphere(100.0).surface(), 20.0);
  ASSERT_EQ(large.points.cols(), first.points.cols());
  // Distances to the surface are single-precision samples.
  EXPECT_LT((large.points - 1e3 * first.points).cwiseAbs().maxCoeff(), 0.5);
}

TEST(InteriorSamples, RefuseWhatCannotBe) {
  const TriangleMesh ball = Sphere(0.1).surface();
  EXPECT_THROW(sample_interior(ball, 0.0), InputError);
  EXPECT_THROW(sample_interior(ball, -1.0), InputError);
  EXPECT_THROW(sample_interior(ball, NAN), InputError);
  EXPECT_THROW(sample_interior(ball, 1e-5), InputError) << "too many";
  TriangleMesh open = ball;
  open.triangles.conservativeResize(3, open.triangles.cols() - 1);
  EXPECT_THROW(sample_interior(open, 0.02), InputError);
}

}  // namespace
}  // namespace pliant
