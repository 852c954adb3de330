#include "pliant/geometry/mesh/display_surface.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pliant {
namespace {

using Eigen::Vector3d;

void expect_closed_outward(const TriangleMesh& mesh, double volume, double tolerance) {
  EXPECT_NO_THROW(validate(mesh, "surface"));
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  EXPECT_NEAR(signed_volume(mesh), volume, tolerance * volume);
}

TEST(DisplaySurface, EnclosesTheVolumeOfTheShape) {
  expect_closed_outward(box_surface(Vector3d(0.5, 1.0, 1.5)), 6.0, 1e-12);
  const double sphere = 4.0 / 3.0 * M_PI * 0.125;
  expect_closed_outward(capsule_surface(0.5, 0.0), sphere, 0.01);
  expect_closed_outward(capsule_surface(0.5, 2.0), sphere + M_PI * 0.25 * 2.0, 0.01);
  expect_closed_outward(cylinder_surface(0.5, 2.0), M_PI * 0.25 * 2.0, 0.01);
}

TEST(DisplaySurface, CapsulesReachFromPoleToPole) {
  for (const double length : {0.0, 2.0}) {
    const TriangleMesh mesh = capsule_surface(0.5, length);
    const Vector3d size(0.5, 0.5, 0.5 * length + 0.5);
    EXPECT_LE((mesh.vertices.rowwise().maxCoeff() - size).norm(), 1e-15) << length;
    EXPECT_LE((mesh.vertices.rowwise().minCoeff() + size).norm(), 1e-15) << length;
  }
}

TEST(DisplaySurface, SquareFacesUp) {
  const TriangleMesh square = square_surface(2.0);
  EXPECT_NO_THROW(validate(square, "square"));
  EXPECT_NEAR(area(square), 4.0, 1e-12);
  EXPECT_EQ(vertex_normals(square).col(0), Vector3d::UnitZ());
}

}  // namespace
}  // namespace pliant
