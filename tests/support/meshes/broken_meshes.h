#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pliant/geometry/distance/primitive_shapes.h"
#include "pliant/geometry/distance/winding_count.h"
#include "pliant/geometry/search/nearest_triangle.h"
#include "support/worlds/surfaces.h"

namespace pliant {

/// Two arms of 1 m x 0.4 m, 0.4 m thick: a closed solid with a concave edge. Each side is cut into
/// squares of 0.1 m, so that a triangle is a small part of it.
inline TriangleMesh fine_bracket() {
  constexpr int kCells = 10, kLayers = 4;
  const auto is_solid = [](int x, int y, int z) {
    const bool within = x >= 0 && x < kCells && y >= 0 && y < kCells && z >= 0 && z < kLayers;
    return within && (x < 4 || y < 4);
  };
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> number((kCells + 1) * (kCells + 1) * (kLayers + 1), -1);
  const auto vertex = [&](const Eigen::Vector3i& at) {
    int& n = number[(at[2] * (kCells + 1) + at[1]) * (kCells + 1) + at[0]];
    if (n < 0) {
      n = static_cast<int>(vertices.size());
      vertices.push_back(0.1 * at.cast<double>());
    }
    return n;
  };
  for (int z = 0; z < kLayers; ++z) {
    for (int y = 0; y < kCells; ++y) {
      for (int x = 0; x < kCells; ++x) {
        for (int side = 0; side < 6 && is_solid(x, y, z); ++side) {
          const int axis = side / 2, sign = side % 2 == 0 ? -1 : 1;
          Eigen::Vector3i cell(x, y, z), next = cell;
          next[axis] += sign;
          if (is_solid(next[0], next[1], next[2])) continue;
          Eigen::Vector3i a = cell;
          if (sign > 0) ++a[axis];
          Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3),
                          v = Eigen::Vector3i::Unit((axis + 2) % 3);
          if (sign < 0) std::swap(u, v);
          const Eigen::Vector3i b = a + u, c = a + u + v, d = a + v;
          triangles.emplace_back(vertex(a), vertex(b), vertex(c));
          triangles.emplace_back(vertex(a), vertex(c), vertex(d));
        }
      }
    }
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t k = 0; k < vertices.size(); ++k) mesh.vertices.col(k) = vertices[k];
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t k = 0; k < triangles.size(); ++k) mesh.triangles.col(k) = triangles[k];
  return mesh;
}

inline TriangleMesh joined_meshes(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh all;
  all.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  all.vertices << a.vertices, b.vertices;
  all.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  all.triangles << a.triangles, (b.triangles.array() + static_cast<int>(a.vertices.cols()));
  return all;
}

/// Without about `share` of its triangles, chosen at random.
inline TriangleMesh with_holes(const TriangleMesh& mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (random() / 4294967296.0 >= share) kept.push_back(t);
  }
  return {mesh.vertices, mesh.triangles(Eigen::all, kept)};
}

/// With about `share` of its triangles turned around.
inline TriangleMesh with_turned(TriangleMesh mesh, double share, unsigned seed) {
  std::mt19937 random(seed);
  for (auto t : mesh.triangles.colwise()) {
    if (random() / 4294967296.0 < share) std::swap(t[1], t[2]);
  }
  return mesh;
}

/// Each triangle twice, the second time turned around and with vertices of its own.
inline TriangleMesh doubled(const TriangleMesh& mesh) {
  TriangleMesh back = mesh;
  back.triangles.row(1).swap(back.triangles.row(2));
  return joined_meshes(mesh, back);
}

/// Each triangle with vertices of its own, up to `by` [m] from where they were: cracks everywhere.
inline TriangleMesh torn(const TriangleMesh& mesh, double by, unsigned seed) {
  std::mt19937 random(seed);
  const auto off = [&] { return by * (2.0 * (random() / 4294967296.0) - 1.0); };
  TriangleMesh all;
  all.triangles.resize(3, mesh.triangles.cols());
  all.vertices.resize(3, 3 * mesh.triangles.cols());
  for (Eigen::Index k = 0; k < mesh.triangles.size(); ++k) {
    const Eigen::Vector3d p = mesh.vertices.col(mesh.triangles.data()[k]);
    all.vertices.col(k) = p + Eigen::Vector3d(off(), off(), off());
    all.triangles.data()[k] = static_cast<int>(k);
  }
  return all;
}

/// With one more triangle between three of its vertices, which makes edges of three triangles.
inline TriangleMesh with_triangle(TriangleMesh mesh, int a, int b, int c) {
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + 1);
  mesh.triangles.col(mesh.triangles.cols() - 1) << a, b, c;
  return mesh;
}

/// The same between its vertices nearest to three places.
inline TriangleMesh with_triangle_at(const TriangleMesh& mesh, const Eigen::Vector3d& a,
                                     const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const auto nearest = [&](const Eigen::Vector3d& place) {
    Eigen::Index vertex;
    (mesh.vertices.colwise() - place).colwise().squaredNorm().minCoeff(&vertex);
    return static_cast<int>(vertex);
  };
  return with_triangle(mesh, nearest(a), nearest(b), nearest(c));
}

/// The fine_bracket() with a single wall within, from one arm's edge to its corner.
inline TriangleMesh with_wall(const TriangleMesh& bracket) {
  return with_triangle_at(bracket, {0.0, 0.1, 0.0}, {0.1, 0.3, 0.0}, {0.0, 0.5, 0.2});
}

/// The fine_bracket() with a single sheet across the open corner between its arms.
inline TriangleMesh with_sheet(const TriangleMesh& bracket) {
  return with_triangle_at(bracket, {0.8, 0.4, 0.2}, {0.4, 0.8, 0.2}, {0.4, 0.4, 0.3});
}

/// The signed distance to what a closed mesh bounds that does not pass through itself.
class WholeDistance {
 public:
  explicit WholeDistance(const TriangleMesh& closed) : winding_(closed), nearest_(closed) {}
  double operator()(const Eigen::Vector3d& p) const {
    const double distance = nearest_(p).distance;
    return winding_(p) != 0 ? -distance : distance;
  }

 private:
  WindingCount winding_;
  NearestTriangle nearest_;
};

/// The greatest difference of a shape's distance from another one within `reach` [m] of its bounds.
template <class Distance>
double greatest_error(const Shape& shape, const Distance& distance, double reach, int points) {
  std::mt19937 random(7);
  const Eigen::AlignedBox3d box = shape.bounds();
  double greatest = 0.0;
  for (int k = 0; k < points; ++k) {
    Eigen::Vector3d p;
    for (int i = 0; i < 3; ++i) {
      const double share = random() / 4294967296.0;
      p[i] = box.min()[i] - reach + share * (box.sizes()[i] + 2.0 * reach);
    }
    greatest = std::max(greatest, std::abs(shape.distance(p) - distance(p)));
  }
  return greatest;
}

}  // namespace pliant
