#include "pliant/models/viscoelastic/mesh_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// A vertex of the part that each vertex belongs to.
std::vector<int> parts_of(std::size_t vertices, const std::vector<Eigen::Vector3i>& triangles) {
  std::vector<int> root(vertices);
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int v) {
    while (root[at(v)] != v) v = root[at(v)] = root[at(root[at(v)])];
    return v;
  };
  for (const Eigen::Vector3i& t : triangles) {
    for (int k = 0; k < 2; ++k) {
      const int a = find(t[k]), b = find(t[k + 1]);
      root[at(std::max(a, b))] = std::min(a, b);
    }
  }
  for (int v = 0; v < static_cast<int>(vertices); ++v) root[at(v)] = find(v);
  return root;
}

}  // namespace

void keep_large_parts(const std::vector<Eigen::Vector3d>& vertices,
                      const std::vector<Eigen::Vector3i>& triangles, double least,
                      TriangleMesh& mesh) {
  const std::vector<int> part = parts_of(vertices.size(), triangles);
  std::vector<double> volume(vertices.size(), 0.0);
  for (const Eigen::Vector3i& t : triangles) {
    // From a vertex of the part itself, so that no digits are lost.
    const int own = part[at(t[0])];
    const Eigen::Vector3d& from = vertices[at(own)];
    volume[at(own)] += (vertices[at(t[0])] - from)
                           .cross(vertices[at(t[1])] - from)
                           .dot(vertices[at(t[2])] - from) /
                       6.0;
  }
  std::vector<int> number(vertices.size(), -1);
  int kept = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (std::abs(volume[at(part[v])]) >= least) number[v] = kept++;
  }
  mesh.vertices.resize(3, kept);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (number[v] >= 0) mesh.vertices.col(number[v]) = vertices[v];
  }
  int last = 0;
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (const Eigen::Vector3i& t : triangles) {
    if (number[at(t[0])] < 0) continue;
    mesh.triangles.col(last++) =
        Eigen::Vector3i(number[at(t[0])], number[at(t[1])], number[at(t[2])]);
  }
  mesh.triangles.conservativeResize(3, last);
}

}  // namespace pliant
