#include "pliant/geometry/mesh/volume_moments.h"

#include <gtest/gtest.h>

#include "pliant/geometry/distance/primitive_shapes.h"

namespace pliant {
namespace {

void expect_same(const VolumeMoments& a, const VolumeMoments& b, double tolerance) {
  EXPECT_NEAR(a.volume, b.volume, tolerance * b.volume);
  EXPECT_LT((a.second - b.second).norm(), tolerance * b.second.norm());
}

TEST(VolumeMoments, OfABoxMeshAreExactWhereverItIs) {
  TriangleMesh mesh = Box({0.1, 0.2, 0.3}).surface();
  mesh.vertices.colwise() += Eigen::Vector3d(1.0, -2.0, 3.0);
  const VolumeMoments found = volume_moments(mesh);
  expect_same(found, box_moments({0.1, 0.2, 0.3}), 1e-11);
  EXPECT_LT((found.center - Eigen::Vector3d(1.0, -2.0, 3.0)).norm(), 1e-12);
}

TEST(VolumeMoments, OfRoundShapesAreThoseOfTheirMeshesButForTheFlatFaces) {
  expect_same(volume_moments(Sphere(0.05).surface()), sphere_moments(0.05), 0.08);
  expect_same(volume_moments(Cylinder(0.05, 0.2).surface()), cylinder_moments(0.05, 0.2), 0.08);
  expect_same(volume_moments(Capsule(0.05, 0.2).surface()), capsule_moments(0.05, 0.2), 0.08);
}

TEST(VolumeMoments, ACapsuleWithoutLengthIsASphere) {
  const VolumeMoments capsule = capsule_moments(0.3, 0.0), sphere = sphere_moments(0.3);
  expect_same(capsule, sphere, 1e-12);
}

}  // namespace
}  // namespace pliant
