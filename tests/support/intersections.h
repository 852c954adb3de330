#pragma once

#include <Eigen/Geometry>
#include <array>
#include <set>

#include "pliant/core/particles.h"

namespace pliant {

/// Of the edges' lengths: an edge and a triangle that meet have a place in common.
constexpr double kSamePlace = 1e-6;

/// How many edges of a triangle mesh pass through triangles that they share no vertex with; every
/// edge is tried with every triangle.
inline int count_intersections(const Positions& x, const Eigen::Matrix3Xi& triangles) {
  std::set<std::array<int, 2>> edges;
  for (const auto t : triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  }
  int count = 0;
  for (const auto& [i, j] : edges) {
    const Eigen::Vector3d p = x.col(i), q = x.col(j);
    for (const auto t : triangles.colwise()) {
      if ((t.array() == i).any() || (t.array() == j).any()) continue;
      // Signed volumes: p and q on different sides, and the line within all three edges.
      const auto volume = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                             const Eigen::Vector3d& c,
                             const Eigen::Vector3d& d) { return (b - a).cross(c - a).dot(d - a); };
      const Eigen::Vector3d a = x.col(t[0]), b = x.col(t[1]), c = x.col(t[2]);
      if (volume(a, b, c, p) * volume(a, b, c, q) >= 0.0) continue;
      const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
      if (!((u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0))) continue;
      // In one plane all volumes are round-off: then the edge's place is not the triangle's.
      const double below = volume(a, b, c, p), above = volume(a, b, c, q);
      const Eigen::Vector3d on_edge = p + below / (below - above) * (q - p);
      const Eigen::Vector3d on_triangle = (u * c + v * a + w * b) / (u + v + w);
      if ((on_edge - on_triangle).norm() <= kSamePlace * ((b - a).norm() + (q - p).norm())) ++count;
    }
  }
  return count;
}

}  // namespace pliant
