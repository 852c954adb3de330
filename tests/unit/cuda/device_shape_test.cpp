// Signed distances and swept points of the CUDA backend, run by the CPU: those of the CPU's shapes
// to single precision.
#include <gtest/gtest.h>

#include <random>

#include "cuda/effects/resident_exchange.h"
#include "cuda/geometry/device_sweep.h"
#include "pliant/geometry/distance/mesh_shape.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/search/sweep.h"

namespace pliant {
namespace {

Eigen::Vector3d vector(const Float3& v) { return {v.x, v.y, v.z}; }
Float3 single(const Eigen::Vector3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

class DeviceGridOf : public testing::Test {
 protected:
  DeviceGridOf() : mesh_(Box({0.2, 0.1, 0.06}).surface()) {
    shape_ = *device_shape(mesh_);
    shape_.grid.samples = mesh_.grid().samples.data();
  }
  Eigen::Vector3d random_place(double reach) {
    std::uniform_real_distribution<double> uniform(-reach, reach);
    Eigen::Vector3d place;
    for (double& x : place) x = uniform(random_);
    // What the device sees is this place, rounded.
    return vector(single(place));
  }

  MeshShape mesh_;
  DeviceShape shape_;
  std::mt19937 random_{7};
};

TEST_F(DeviceGridOf, DistancesAreThoseOfTheMesh) {
  int outside = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d place = random_place(0.2);
    const SurfacePoint exact = mesh_.query(place);
    const DeviceSurfacePoint found = query(shape_, single(place));
    outside += mesh_.bounds().exteriorDistance(place) > 0.03 ? 1 : 0;
    EXPECT_NEAR(found.distance, exact.distance, 1e-6);
    // A place on the border of two cells may be in the other one.
    if ((vector(found.normal) - exact.normal).norm() > 1e-3) {
      const Eigen::Vector3d beside = mesh_.query(place + Eigen::Vector3d::Constant(1e-7)).normal;
      const Eigen::Vector3d before = mesh_.query(place - Eigen::Vector3d::Constant(1e-7)).normal;
      EXPECT_GT((beside - before).norm(), 1e-3) << place.transpose();
    }
  }
  EXPECT_GT(outside, 500) << "the grid's outside is not tested";
}

TEST_F(DeviceGridOf, PointsMeetItWhereTheyDoOnTheCpu) {
  constexpr double kOffset = 0.004;
  int hits = 0;
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3d from = random_place(0.3), to = random_place(0.3);
    const SweepHit exact = sweep_point(mesh_, from, to, kOffset);
    const DeviceHit found = sweep(shape_, single(from), single(to), kOffset);
    const double nearest = std::abs(mesh_.distance(from) - kOffset);
    if (nearest < 1e-6) continue;  // rounding decides whether it began inside
    EXPECT_EQ(found.began_inside, exact.hit && exact.time == 0.0);
    if (found.is_hit != exact.hit) {
      // Grazing.
      double least = 1.0;
      for (int s = 0; s <= 2000; ++s) {
        least = std::min(least, mesh_.distance(from + s / 2000.0 * (to - from)));
      }
      EXPECT_NEAR(least, kOffset, 1e-3) << from.transpose() << " to " << to.transpose();
      continue;
    }
    if (!exact.hit || exact.time == 0.0) continue;
    ++hits;
    const double steep = std::abs(exact.normal.dot((to - from).normalized()));
    EXPECT_LE((vector(found.point) - exact.point).norm(), 2e-5 / std::max(steep, 0.05));
  }
  EXPECT_GT(hits, 200) << "few points meet it";
}

}  // namespace
}  // namespace pliant
