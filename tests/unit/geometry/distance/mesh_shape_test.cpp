#include "pliant/geometry/distance/mesh_shape.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>
#include <random>

#include "pliant/geometry/distance/closest_point.h"
#include "pliant/geometry/distance/distance_grid.h"
#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/distance/voxel_signs.h"
#include "pliant/geometry/mesh/grid.h"
#include "support/expect_refusal.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

MeshShapeOptions voxels(double size) {
  MeshShapeOptions options;
  options.voxel_size = size;
  return options;
}

double distance_by_force(const TriangleMesh& mesh, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto t : mesh.triangles.colwise()) {
    const Vector3d nearest = closest_point_on_triangle(
        p, mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2]));
    least = std::min(least, (nearest - p).norm());
  }
  return least;
}

// Two arms of 1 m x 0.4 m, 0.4 m thick: a solid with a concave edge.
TriangleMesh angle_bracket() {
  const double outline[6][2] = {{0, 0}, {1, 0}, {1, 0.4}, {0.4, 0.4}, {0.4, 1}, {0, 1}};
  TriangleMesh mesh;
  mesh.vertices.resize(3, 12);
  for (int i = 0; i < 12; ++i) {
    mesh.vertices.col(i) << outline[i % 6][0], outline[i % 6][1], i < 6 ? 0.0 : 0.4;
  }
  mesh.triangles.resize(3, 20);
  int next = 0;
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    mesh.triangles.col(next++) << i, j, j + 6;
    mesh.triangles.col(next++) << i, j + 6, i + 6;
  }
  const int caps[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
  for (const auto& c : caps) {
    mesh.triangles.col(next++) << c[0], c[2], c[1];
    mesh.triangles.col(next++) << c[0] + 6, c[1] + 6, c[2] + 6;
  }
  return mesh;
}

class RandomPoints {
 public:
  explicit RandomPoints(unsigned seed) : random_(seed) {}
  Vector3d operator()(const Eigen::AlignedBox3d& box) {
    const Vector3d u(uniform_(random_), uniform_(random_), uniform_(random_));
    return box.min() + u.cwiseProduct(box.sizes());
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

Eigen::AlignedBox3d widened(Eigen::AlignedBox3d box, double by) {
  return Eigen::AlignedBox3d(box.min().array() - by, box.max().array() + by);
}

TEST(MeshShape, DistanceOfASphereIsSecondOrderAccurateNearTheSurface) {
  const Sphere sphere(1.0);
  const MeshShape shape(sphere.surface());
  RandomPoints random(1);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = random(widened(shape.bounds(), 0.1));
    if (std::abs(sphere.distance(p)) > 0.5) continue;
    // The display surface is inscribed by 0.5 %.
    EXPECT_NEAR(shape.distance(p), sphere.distance(p), 0.01);
    EXPECT_GT(shape.query(p).normal.dot(p.normalized()), 0.99);
  }
}

TEST(MeshShape, DistanceIsThatToTheNearestTriangle) {
  const TriangleMesh mesh = angle_bracket();
  const MeshShape shape(mesh);
  RandomPoints random(2);
  double sum = 0.0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = random(widened(shape.bounds(), 3.0 * shape.voxel_size()));
    const double error = std::abs(std::abs(shape.distance(p)) - distance_by_force(mesh, p));
    EXPECT_LT(error, shape.voxel_size()) << p.transpose();
    sum += error;
  }
  EXPECT_LT(sum / 5000, 0.03 * shape.voxel_size());
}

TEST(MeshShape, KnowsInsideFromOutside) {
  const MeshShape shape(angle_bracket());
  EXPECT_LT(shape.distance({0.2, 0.2, 0.2}), -0.15);
  EXPECT_LT(shape.distance({0.8, 0.2, 0.2}), -0.15);
  EXPECT_GT(shape.distance({0.7, 0.7, 0.2}), 0.25);
  EXPECT_GT(shape.query({0.7, 0.45, 0.2}).normal.y(), 0.99);
  EXPECT_GT(shape.query({0.7, 0.35, 0.2}).normal.y(), 0.99);
}

TEST(MeshShape, NormalIsTheGradient) {
  const MeshShape shape(Sphere(1.0).surface());
  constexpr double kStep = 1e-7;
  RandomPoints random(4);
  int smooth = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = random(shape.bounds());
    if (p.norm() < 0.2) continue;
    Vector3d gradient;
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = kStep * Vector3d::Unit(k);
      gradient[k] = (shape.distance(p + step) - shape.distance(p - step)) / (2.0 * kStep);
    }
    smooth += (gradient.normalized() - shape.query(p).normal).norm() < 1e-4;
  }
  EXPECT_GT(smooth, 1950);  // the others straddle two cells
}

TEST(MeshShape, FarDistancesAreLowerBoundsAndNormalsPointAway) {
  const TriangleMesh mesh = angle_bracket();
  const MeshShape shape(mesh);
  RandomPoints random(5);
  for (const double reach : {0.2, 1.0, 10.0}) {
    for (int i = 0; i < 1000; ++i) {
      const Vector3d p = random(widened(shape.bounds(), reach));
      const double exact = distance_by_force(mesh, p);
      EXPECT_LT(std::abs(shape.distance(p)), exact + shape.voxel_size());
      if (exact < 0.1 || shape.bounds().contains(p)) continue;
      EXPECT_GT(shape.distance(p), 0.4 * exact);
      const Vector3d nearest = p - exact * shape.query(p).normal;
      EXPECT_LT(shape.bounds().exteriorDistance(nearest), 0.3 * exact);
    }
  }
}

TEST(MeshShape, AMillionPointsNeverGiveNaN) {
  const MeshShape shape(Box(Vector3d(1.0, 0.5, 0.25)).surface());
  RandomPoints random(6);
  const double reaches[] = {-0.1249, 0.0, 0.05, 0.1, 1.0, 1e6, 1e100};
  for (int i = 0; i < 1000000; ++i) {
    const Vector3d p = random(widened(shape.bounds(), reaches[i % 7]));
    const SurfacePoint near = shape.query(p);
    if (!std::isfinite(near.distance) || std::abs(near.normal.norm() - 1.0) > 1e-9) {
      ADD_FAILURE() << p.transpose() << ": " << near.distance << ", " << near.normal.transpose();
    }
  }
}

TEST(MeshShape, CentreCornersAndPointsThatAreNoNumbersAreSafe) {
  const MeshShape shape(Box(Vector3d::Ones()).surface());
  for (const double x : {0.0, 1e-300, 0.5, -0.5, 0.5625, 1e6, -1e6}) {
    const SurfacePoint near = shape.query({x, x, x});
    EXPECT_TRUE(std::isfinite(near.distance));
    EXPECT_NEAR(near.normal.norm(), 1.0, 1e-9);
  }
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  shape.query({nan, nan, nan});  // no crash
  shape.query({inf, -inf, 0.0});
}

TEST(MeshShape, SamplesAreTheSameEveryTime) {
  const MeshShape a(angle_bracket()), b(angle_bracket());
  RandomPoints random(8);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = random(widened(a.bounds(), 0.05));
    EXPECT_EQ(a.distance(p), b.distance(p));
  }
}

TEST(MeshShape, WorksFarFromTheOriginAndForSmallObjects) {
  TriangleMesh far = angle_bracket();
  far.vertices.colwise() += Vector3d(1000.0, -2000.0, 500.0);
  EXPECT_NEAR(MeshShape(far).distance(Vector3d(1000.7, -1999.5, 500.2)), 0.1, 0.005);
  TriangleMesh small = angle_bracket();
  small.vertices *= 1e-3;
  EXPECT_NEAR(MeshShape(small).distance(Vector3d(0.7e-3, 0.5e-3, 0.2e-3)), 0.1e-3, 0.005e-3);
}

TEST(MeshShape, MendsWinding) {
  TriangleMesh inward = angle_bracket();
  inward.triangles.row(0).swap(inward.triangles.row(1));
  TriangleMesh mixed = angle_bracket();
  std::swap(mixed.triangles(0, 3), mixed.triangles(1, 3));
  for (const TriangleMesh& mesh : {inward, mixed}) {
    const MeshShape shape(mesh);
    EXPECT_LT(shape.distance({0.2, 0.2, 0.2}), -0.15);
    EXPECT_GT(signed_volume(shape.surface()), 0.0);
  }
}

TEST(MeshShape, TellsNameBoundsAndVoxelSize) {
  const MeshShape shape(angle_bracket());
  EXPECT_EQ(shape.name(), "mesh");
  EXPECT_FALSE(shape.convex());
  EXPECT_EQ(shape.bounds().max(), Vector3d(1.0, 1.0, 0.4));
  EXPECT_EQ(shape.voxel_size(), 1.0 / 64.0);
  EXPECT_EQ(MeshShape(angle_bracket(), voxels(0.05)).voxel_size(), 0.05);
  EXPECT_EQ(shape.surface().triangles.cols(), 20);
}

TEST(MeshShape, RefusesOpenMeshes) {
  TriangleMesh open = angle_bracket();
  open.triangles.conservativeResize(3, 19);
  expect_refusal([&] { MeshShape{open}; }, {"open", "3 boundary edges"});
  expect_refusal([] { MeshShape(make_grid({})); }, {"open", "4 boundary edges"});
}

TEST(MeshShape, RefusesBadMeshes) {
  expect_refusal([] { MeshShape{TriangleMesh()}; }, {"mesh shape: ", "no vertices"});
  TriangleMesh mesh = angle_bracket();
  mesh.vertices(0, 0) = std::nan("");
  expect_refusal([&] { MeshShape{mesh}; }, {"not finite: 0"});
  mesh = angle_bracket();
  mesh.triangles(0, 0) = 77;
  expect_refusal([&] { MeshShape{mesh}; }, {"outside [0, 11]"});
}

TEST(MeshShape, RefusesBadVoxelSizes) {
  for (const double bad : {-0.1, 1.5, std::nan(""), std::numeric_limits<double>::infinity()}) {
    expect_refusal([&] { MeshShape(angle_bracket(), voxels(bad)); }, {"voxel_size", "(0, 1]"});
  }
  for (const double tiny : {1e-4, 1e-300}) {
    expect_refusal([&] { MeshShape(angle_bracket(), voxels(tiny)); }, {"voxel_size", "at most"});
  }
}

TEST(MeshShape, RefusesASolidThinnerThanItsSamples) {
  const TriangleMesh sheet = Box(Vector3d(1.0, 1.0, 1e-4)).surface();
  expect_refusal([&] { MeshShape{sheet}; }, {"too thin", "smaller voxel_size"});
}

/// Of a bracket whose middle is further from its surface than OpenVDB's band is wide.
DistanceGrid bracket_samples(int threads) {
  const TriangleMesh mesh = angle_bracket();
  DistanceGrid grid =
      lay_grid({mesh.vertices.rowwise().minCoeff(), mesh.vertices.rowwise().maxCoeff()}, 0.02);
  tbb::task_arena(threads).execute([&] { sample_signed_distance(mesh, grid); });
  return grid;
}

TEST(DistanceGrid, IsTheSameForAnyNumberOfThreadsAndExactAtEachSample) {
  const DistanceGrid one = bracket_samples(1);
  for (const int threads : {2, 4, 7}) EXPECT_EQ(bracket_samples(threads).samples, one.samples);
  const TriangleMesh mesh = angle_bracket();
  for (std::size_t i = 0; i < one.samples.size(); i += 97) {
    const auto row = static_cast<int>(i) / one.count[0];
    const Vector3d at(static_cast<int>(i) % one.count[0], row % one.count[1], row / one.count[1]);
    const double exact = distance_by_force(mesh, one.origin + one.spacing * at);
    EXPECT_NEAR(std::abs(one.samples[i]), exact, 1e-7);
  }
}

TEST(VoxelSigns, SaysWhatToDoWhereItsLibraryIsNotFound) {
  expect_refusal([] { load_voxel_signs("libpliant_elsewhere.so"); },
                 {"mesh shape", "cannot load libpliant_elsewhere.so", "beside libpliant_core.so"});
  // Another library, which samples no mesh.
  expect_refusal([] { load_voxel_signs("libm.so.6"); },
                 {"cannot load libm.so.6", kVoxelSignsSymbol});
}

}  // namespace
}  // namespace pliant
