// Surfaces of the CUDA backend, their kernels run by the CPU, against ParticleSurface's own.
#include "cuda/models/viscoelastic/device_surface.h"

#include <gtest/gtest.h>

#include "cuda/core/host_executor.h"
#include "pliant/models/viscoelastic/particle_surface.h"
#include "support/random.h"
#include "support/solvers/failing_executor.h"
#include "support/worlds/particle_bodies.h"

namespace pliant {
namespace {

/// A ball, a film one particle thick, drops, and a particle of its own.
Eigen::Matrix3Xd shapes() {
  constexpr double spacing = 0.01;
  static const Eigen::Matrix3Xd ball = sample_interior(Sphere(0.06).surface(), spacing).points;
  constexpr int kFilm = 10, kDrops = 40;
  Random random(5);
  Eigen::Matrix3Xd x(3, ball.cols() + kFilm * kFilm + kDrops + 1);
  x.leftCols(ball.cols()) = ball;
  for (int i = 0; i < kFilm * kFilm; ++i) {
    x.col(ball.cols() + i) =
        Eigen::Vector3d(0.15 + spacing * (i % kFilm), spacing * (i / kFilm), 0);
  }
  x.middleCols(ball.cols() + kFilm * kFilm, kDrops) =
      random.positions(kDrops, 0.04).colwise() + Eigen::Vector3d(0, 0.2, -0.1);
  x.rightCols(1) = Eigen::Vector3d(-0.3, 0, 0.2);
  return x;
}

template <class Executor = HostExecutor>
ParticleSurface made(const Eigen::Matrix3Xd& x, const SurfaceStyle& style, bool on_device) {
  ParticleSurface surface;
  if (on_device) surface.set_device(std::make_unique<DeviceSurface<Executor>>());
  surface.update(x, Eigen::VectorXd::Constant(x.cols(), 1e-6), style);
  return surface;
}

class DeviceSurfaceOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Details, DeviceSurfaceOf, testing::Values(2, 3, 5));

TEST_P(DeviceSurfaceOf, HasTheTrianglesOfTheCpu) {
  const Eigen::Matrix3Xd x = shapes();
  const SurfaceStyle style = {0.02, GetParam(), false};
  const TriangleMesh exact = made(x, style, false).mesh(), found = made(x, style, true).mesh();
  ASSERT_GT(exact.triangles.cols(), 1000);
  ASSERT_EQ(found.triangles, exact.triangles);
  EXPECT_LE((found.vertices - exact.vertices).colwise().norm().maxCoeff(), 2e-5 * style.support);
  EXPECT_FALSE(found.vertices == exact.vertices) << "it was made by the device";
}

TEST(DeviceSurface, IsMadeAnewForEachState) {
  ParticleSurface surface;
  surface.set_device(std::make_unique<DeviceSurface<HostExecutor>>());
  Eigen::Matrix3Xd x = shapes();
  const SurfaceStyle style = {0.02, 2, false};
  // Fewer, more, none.
  for (Eigen::Index n : {x.cols(), x.cols() / 3, x.cols(), Eigen::Index{0}, x.cols() / 2}) {
    const Eigen::Matrix3Xd some = x.leftCols(n);
    surface.update(some, Eigen::VectorXd::Constant(n, 1e-6), style);
    const TriangleMesh exact = made(some, style, false).mesh();
    ASSERT_EQ(surface.mesh().triangles, exact.triangles);
    EXPECT_LE((surface.mesh().vertices - exact.vertices).norm(), 1e-5 * style.support * n);
  }
}

TEST(DeviceSurface, LeavesToTheCpuWhatItCannotMake) {
  Eigen::Matrix3Xd x = shapes();
  const SurfaceStyle ellipsoids = {0.02, 3, true};
  EXPECT_EQ(made(x, ellipsoids, true).mesh().vertices, made(x, ellipsoids, false).mesh().vertices);
  x(2, 0) = 1e3;  // farther than whole numbers reach
  const SurfaceStyle style = {0.02, 2, false};
  const ParticleSurface far = made(x, style, true);
  EXPECT_EQ(far.mesh().vertices, made(x, style, false).mesh().vertices);
  EXPECT_TRUE(far.has_device());
}

TEST(DeviceSurface, AFailureIsToldOnceAndTheCpuGoesOn) {
  const Eigen::Matrix3Xd x = shapes();
  const SurfaceStyle style = {0.02, 2, false};
  FailingExecutor::left = 1;
  ParticleSurface surface = made<FailingExecutor>(x, style, true);
  EXPECT_EQ(surface.mesh().vertices, made(x, style, false).mesh().vertices);
  EXPECT_FALSE(surface.has_device());
  EXPECT_EQ(surface.take_device_failure(), "out of memory");
  EXPECT_EQ(surface.take_device_failure(), "");
}

}  // namespace
}  // namespace pliant
