#include "pliant/geometry/meshing/marching_cubes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {
namespace {

constexpr int kNodes = 12;  // along each side

/// The surface where values on a grid are positive; the grid's border is negative.
TriangleMesh polygonise(const std::vector<double>& values) {
  const auto index = [](const Eigen::Array3i& at) {
    return static_cast<std::size_t>(at[0] + kNodes * (at[1] + kNodes * at[2]));
  };
  std::map<std::pair<std::size_t, int>, int> number;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  for (int z = 0; z + 1 < kNodes; ++z) {
    for (int y = 0; y + 1 < kNodes; ++y) {
      for (int x = 0; x + 1 < kNodes; ++x) {
        const auto corner = [&](int c) {
          return Eigen::Array3i(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1));
        };
        int inside = 0;
        for (int c = 0; c < 8; ++c) inside |= (values[index(corner(c))] > 0.0 ? 1 : 0) << c;
        for (const auto& triangle : MarchingCubes::triangles(inside)) {
          Eigen::Vector3i t;
          for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Array3i low = corner(MarchingCubes::edge_corner(triangle[k]));
            const int axis = MarchingCubes::edge_axis(triangle[k]);
            const auto found =
                number.try_emplace({index(low), axis}, static_cast<int>(vertices.size()));
            if (found.second) {
              Eigen::Array3i high = low;
              ++high[axis];
              const double a = values[index(low)], b = values[index(high)];
              EXPECT_LT(a * b, 0.0) << "on an edge that nothing crosses";
              Eigen::Vector3d p = low.cast<double>().matrix();
              p[axis] += a / (a - b);
              vertices.push_back(p);
            }
            t[static_cast<Eigen::Index>(k)] = found.first->second;
          }
          triangles.push_back(t);
        }
      }
    }
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    mesh.vertices.col(static_cast<Eigen::Index>(k)) = vertices[k];
  }
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    mesh.triangles.col(static_cast<Eigen::Index>(k)) = triangles[k];
  }
  return mesh;
}

std::vector<double> field(const std::function<double(const Eigen::Vector3d&)>& f) {
  std::vector<double> values;
  for (int z = 0; z < kNodes; ++z) {
    for (int y = 0; y < kNodes; ++y) {
      for (int x = 0; x < kNodes; ++x) {
        const bool border = x * y * z == 0 || x == kNodes - 1 || y == kNodes - 1 || z == kNodes - 1;
        values.push_back(border ? -1.0 : f({double(x), double(y), double(z)}));
      }
    }
  }
  return values;
}

/// How often each directed edge occurs; a closed, oriented surface has each as often as its
/// reverse.
void expect_closed(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> balance;
  for (const auto t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      balance[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  for (const auto& [edge, count] : balance) EXPECT_EQ(count, 0) << edge.first << " " << edge.second;
}

TEST(MarchingCubes, NothingWhereNothingChanges) {
  EXPECT_TRUE(MarchingCubes::triangles(0).empty());
  EXPECT_TRUE(MarchingCubes::triangles(255).empty());
}

TEST(MarchingCubes, OneCornerIsOneTriangleThatFacesAway) {
  const auto& triangles = MarchingCubes::triangles(1);
  ASSERT_EQ(triangles.size(), 1u);
  const TriangleMesh mesh = polygonise(
      field([](const Eigen::Vector3d& p) { return 4.5 - (p.array() - 5.5).matrix().norm(); }));
  EXPECT_GT(signed_volume(mesh), 0.0);
}

TEST(MarchingCubes, ABallIsClosedAndHasItsVolume) {
  const double radius = 4.5;
  const TriangleMesh mesh = polygonise(
      field([&](const Eigen::Vector3d& p) { return radius - (p.array() - 5.47).matrix().norm(); }));
  validate(mesh, "ball");
  EXPECT_TRUE(boundary_vertices(mesh).empty());
  // Chords of edges up to √3 lie up to 3/(8 r) inside: below 3 · 3/(8 r²) of the volume.
  const double volume = 4.0 / 3.0 * M_PI * radius * radius * radius;
  EXPECT_LT(signed_volume(mesh), volume);
  EXPECT_GT(signed_volume(mesh), (1.0 - 9.0 / (8.0 * radius * radius)) * volume);
}

TEST(MarchingCubes, AnyValuesGiveAClosedSurface) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    // Far from smooth: every case of the table, the ambiguous ones too.
    expect_closed(polygonise(field([&](const Eigen::Vector3d&) {
      return (static_cast<double>(random()) + 0.5) / 4294967296.0 - 0.3 - 0.02 * trial;
    })));
  }
}

}  // namespace
}  // namespace pliant
