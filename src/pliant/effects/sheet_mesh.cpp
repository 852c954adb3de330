#include "pliant/effects/sheet_mesh.h"

#include <algorithm>

#include "pliant/geometry/triangle_mesh.h"

namespace pliant {

SheetMesh::SheetMesh(const Positions& rest_places, const Eigen::Matrix3Xi& all_triangles)
    : rest(places_in(rest_places), places_in(rest_places) + rest_places.cols()),
      triangles(all_triangles) {
  const Edges found = pliant::edges({rest_places, triangles});
  edges.resize(2, static_cast<Eigen::Index>(found.vertices.size()));
  double length = 0.0;
  for (std::size_t e = 0; e < found.vertices.size(); ++e) {
    const auto [a, b] = found.vertices[e];
    edges.col(static_cast<Eigen::Index>(e)) << a, b;
    length += (rest_places.col(a) - rest_places.col(b)).norm();
  }
  mean_edge = length / static_cast<double>(std::max<Eigen::Index>(1, edges.cols()));
  take_edges();
  label_pieces();
}

void SheetMesh::take_edges() {
  begins.assign(rest.size() + 1, 0);
  for (const int i : edges.reshaped()) ++begins[static_cast<std::size_t>(i) + 1];
  for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
  neighbors.resize(static_cast<std::size_t>(edges.size()));
  std::vector<int> next(begins.begin(), begins.end() - 1);
  for (const auto edge : edges.colwise()) {
    for (int k = 0; k < 2; ++k) {
      int& at = next[static_cast<std::size_t>(edge[k])];
      neighbors[static_cast<std::size_t>(at++)] = edge[1 - k];
    }
  }
  for (std::size_t i = 0; i < rest.size(); ++i) {
    std::sort(neighbors.begin() + begins[i], neighbors.begin() + begins[i + 1]);
  }
}

void SheetMesh::label_pieces() {
  pieces.assign(rest.size(), -1);
  std::vector<int> open;
  for (std::size_t seed = 0; seed < pieces.size(); ++seed) {
    if (pieces[seed] >= 0) continue;
    pieces[seed] = static_cast<int>(seed);
    open.assign(1, static_cast<int>(seed));
    while (!open.empty()) {
      const auto i = static_cast<std::size_t>(open.back());
      open.pop_back();
      for (int k = begins[i]; k < begins[i + 1]; ++k) {
        const int other = neighbors[static_cast<std::size_t>(k)];
        int& piece = pieces[static_cast<std::size_t>(other)];
        if (piece >= 0) continue;
        piece = static_cast<int>(seed);
        open.push_back(other);
      }
    }
  }
}

}  // namespace pliant
