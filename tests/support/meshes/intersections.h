#pragma once

#include <Eigen/Geometry>
#include <array>
#include <set>

#include "pliant/core/body/particles.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

/// Of the edges' lengths: an edge and a triangle that meet have a place in common.
constexpr double kSamePlace = 1e-6;

/// Each edge of some triangles once.
inline std::set<std::array<int, 2>> edges_of(const Eigen::Matrix3Xi& triangles) {
  std::set<std::array<int, 2>> edges;
  for (const auto t : triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  }
  return edges;
}

/// Whether the edge from p to q passes through a triangle.
inline bool passes_through(const Eigen::Vector3d& p, const Eigen::Vector3d& q,
                           const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c) {
  // Signed volumes: p and q on different sides, and the line within all three edges.
  const auto volume = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                         const Eigen::Vector3d& c,
                         const Eigen::Vector3d& d) { return (b - a).cross(c - a).dot(d - a); };
  const double below = volume(a, b, c, p), above = volume(a, b, c, q);
  if (below * above >= 0.0) return false;
  const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
  if (!((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0))) return false;
  // In one plane all volumes are round-off: then the edge's place is not the triangle's.
  const Eigen::Vector3d on_edge = p + below / (below - above) * (q - p);
  const Eigen::Vector3d on_triangle = (u * c + v * a + w * b) / (u + v + w);
  return (on_edge - on_triangle).norm() <= kSamePlace * ((b - a).norm() + (q - p).norm());
}

/// How many edges of a triangle mesh pass through triangles that they share no vertex with; every
/// edge is tried with every triangle.
inline int count_intersections(const Positions& x, const Eigen::Matrix3Xi& triangles) {
  int count = 0;
  for (const auto& [i, j] : edges_of(triangles)) {
    for (const auto t : triangles.colwise()) {
      if ((t.array() == i).any() || (t.array() == j).any()) continue;
      count += passes_through(x.col(i), x.col(j), x.col(t[0]), x.col(t[1]), x.col(t[2]));
    }
  }
  return count;
}

/// How many edges of one surface pass through triangles of another; of those near the other's box
/// every edge is tried with every triangle.
inline int count_passages(const TriangleMesh& one, const TriangleMesh& other) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(other.vertices.rowwise().minCoeff()),
                                Eigen::Vector3d(other.vertices.rowwise().maxCoeff()));
  int count = 0;
  for (const auto& [i, j] : edges_of(one.triangles)) {
    const Eigen::Vector3d p = one.vertices.col(i), q = one.vertices.col(j);
    if (!box.intersects(Eigen::AlignedBox3d(p.cwiseMin(q), p.cwiseMax(q)))) continue;
    for (const auto t : other.triangles.colwise()) {
      count += passes_through(p, q, other.vertices.col(t[0]), other.vertices.col(t[1]),
                              other.vertices.col(t[2]));
    }
  }
  return count;
}

}  // namespace pliant
