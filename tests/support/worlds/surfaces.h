#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/math/pi.h"

namespace pliant {

/// An icosahedron with each triangle cut into four `levels` times, vertices on the unit sphere:
/// 20 * 4^levels triangles.
inline TriangleMesh icosphere(int levels) {
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  std::vector<Eigen::Vector3d> v = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                    {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                    {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (auto& p : v) p.normalize();
  std::vector<Eigen::Vector3i> t = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<int>(v.size()));
      if (is_new)
        v.push_back((v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)]).normalized());
      return place->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const auto& c : t) {
      const int ab = middle(c[0], c[1]), bc = middle(c[1], c[2]), ca = middle(c[2], c[0]);
      finer.insert(finer.end(), {{c[0], ab, ca}, {ab, c[1], bc}, {ca, bc, c[2]}, {ab, bc, ca}});
    }
    t = finer;
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(v.size()));
  for (std::size_t i = 0; i < v.size(); ++i) mesh.vertices.col(static_cast<Eigen::Index>(i)) = v[i];
  mesh.triangles.resize(3, static_cast<Eigen::Index>(t.size()));
  for (std::size_t i = 0; i < t.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = t[i];
  return mesh;
}

/// A torus about z: 2 * around * across triangles, its vertices on it.
inline TriangleMesh torus_surface(double ring, double tube, int around, int across) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * across);
  mesh.triangles.resize(3, 2 * around * across);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2.0 * kPi * i / around, w = 2.0 * kPi * j / across;
      const double r = ring + tube * std::cos(w);
      const int here = i * across + j, up = i * across + (j + 1) % across;
      const int next = (i + 1) % around * across + j;
      const int both = (i + 1) % around * across + (j + 1) % across;
      mesh.vertices.col(here) << r * std::cos(u), r * std::sin(u), tube * std::sin(w);
      mesh.triangles.col(2 * here) << here, next, both;
      mesh.triangles.col(2 * here + 1) << here, both, up;
    }
  }
  return mesh;
}

/// Both meshes in one, not joined.
inline TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  mesh.vertices << a.vertices, b.vertices;
  mesh.triangles.resize(3, a.triangles.cols() + b.triangles.cols());
  mesh.triangles << a.triangles,
      (b.triangles.array() + static_cast<int>(a.vertices.cols())).matrix();
  return mesh;
}

/// Without its last `count` triangles; vertices that lose all theirs must not arise.
inline TriangleMesh without_last(TriangleMesh mesh, int count) {
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() - count);
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Eigen::Vector3d& by) {
  mesh.vertices.colwise() += by;
  return mesh;
}

inline TriangleMesh scaled(TriangleMesh mesh, double by) {
  mesh.vertices *= by;
  return mesh;
}

}  // namespace pliant
