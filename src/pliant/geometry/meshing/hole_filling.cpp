#include "pliant/geometry/meshing/hole_filling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace pliant {
namespace {

/// Edges of the triangles that lack their opposite, reversed: from each vertex to the next ones.
std::map<int, std::set<int>> rim_edges(const TriangleMesh& mesh) {
  std::set<std::pair<int, int>> directed;
  for (const auto t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) directed.emplace(t[k], t[(k + 1) % 3]);
  }
  std::map<int, std::set<int>> next;
  for (const auto& [a, b] : directed) {
    if (directed.count({b, a}) == 0) next[b].insert(a);
  }
  return next;
}

double width_of(const TriangleMesh& mesh, const std::vector<int>& rim) {
  Eigen::AlignedBox3d bounds;
  for (const int v : rim) bounds.extend(Eigen::Vector3d(mesh.vertices.col(v)));
  return bounds.sizes().maxCoeff();
}

}  // namespace

std::vector<Hole> find_holes(const TriangleMesh& mesh) {
  std::map<int, std::set<int>> next = rim_edges(mesh);
  std::vector<Hole> holes;
  while (!next.empty()) {
    std::vector<int> walk = {next.begin()->first};
    std::map<int, std::size_t> place = {{walk[0], 0}};
    // As many edges enter a vertex as leave it, so that a walk closes where it meets itself.
    do {
      const auto from = next.find(walk.back());
      const int to = *from->second.begin();
      from->second.erase(from->second.begin());
      if (from->second.empty()) next.erase(from);
      const auto seen = place.find(to);
      if (seen == place.end()) {
        place[to] = walk.size();
        walk.push_back(to);
        continue;
      }
      const auto first = walk.begin() + static_cast<std::ptrdiff_t>(seen->second);
      Hole hole;
      hole.rim.assign(first, walk.end());
      hole.width = width_of(mesh, hole.rim);
      for (std::size_t k = 1; k < hole.rim.size(); ++k) place.erase(hole.rim[k]);
      walk.erase(first + 1, walk.end());
      holes.push_back(std::move(hole));
    } while (walk.size() > 1);
  }
  return holes;
}

void fill_holes(TriangleMesh& mesh, const std::vector<Hole>& holes) {
  std::size_t added = 0;
  for (const Hole& hole : holes) added += hole.rim.size();
  auto vertex = mesh.vertices.cols();
  auto triangle = mesh.triangles.cols();
  mesh.vertices.conservativeResize(3, vertex + static_cast<Eigen::Index>(holes.size()));
  mesh.triangles.conservativeResize(3, triangle + static_cast<Eigen::Index>(added));
  for (const Hole& hole : holes) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < hole.rim.size(); ++k) {
      centre += mesh.vertices.col(hole.rim[k]) / static_cast<double>(hole.rim.size());
      mesh.triangles.col(triangle++) << hole.rim[k], hole.rim[(k + 1) % hole.rim.size()],
          static_cast<int>(vertex);
    }
    mesh.vertices.col(vertex++) = centre;
  }
}

}  // namespace pliant
