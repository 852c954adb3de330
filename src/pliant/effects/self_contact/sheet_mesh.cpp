#include "pliant/effects/self_contact/sheet_mesh.h"

#include <algorithm>

#include "pliant/core/parallel/parallel_reduce.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

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
  triangles_of_ = rows_of(triangles);
  edges_of_ = rows_of(edges);
}

template <int kCorners>
SheetMesh::Rows SheetMesh::rows_of(
    const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices) const {
  Rows rows;
  rows.begins.assign(rest.size() + 1, 0);
  for (const int i : simplices.reshaped()) ++rows.begins[static_cast<std::size_t>(i) + 1];
  for (std::size_t i = 1; i < rows.begins.size(); ++i) rows.begins[i] += rows.begins[i - 1];
  rows.numbers.resize(static_cast<std::size_t>(simplices.size()));
  std::vector<int> next(rows.begins.begin(), rows.begins.end() - 1);
  for (int s = 0; s < simplices.cols(); ++s) {
    for (const int i : simplices.col(s)) {
      rows.numbers[static_cast<std::size_t>(next[static_cast<std::size_t>(i)]++)] = s;
    }
  }
  return rows;
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

namespace {

// Vertices or edges that a thread looks at at once.
constexpr int kGrain = 256;

/// Of the pairs of `own` simplices with those that edges join to it; what has no distance counts
/// not.
class LeastThickness {
 public:
  LeastThickness(const SheetMesh& mesh, double thickness)
      : mesh_(mesh), joints_(mesh.joints()), least_(thickness) {}

  void look_at_vertex(int v) {
    for (const int joined : joined_to(v)) {
      for (const int t : mesh_.triangles_of(joined)) {
        const auto c = mesh_.triangles.col(t);
        if ((c.array() == v).any()) continue;
        const int particles[4] = {v, c[0], c[1], c[2]};
        look(SimplexPair::kPointTriangle, particles);
      }
    }
  }
  void look_at_edge(int e) {
    const auto own = mesh_.edges.col(e);
    for (const int end : own) {
      for (const int joined : joined_to(end)) {
        for (const int f : mesh_.edges_of(joined)) {
          const auto other = mesh_.edges.col(f);
          if (f <= e || (other.array() == own[0]).any() || (other.array() == own[1]).any())
            continue;
          const int particles[4] = {own[0], own[1], other[0], other[1]};
          look(SimplexPair::kSegments, particles);
        }
      }
    }
  }
  double least() const { return least_; }

 private:
  SheetMesh::Numbers joined_to(int vertex) const {
    const int* all = mesh_.neighbors.data();
    const auto k = static_cast<std::size_t>(vertex);
    return {all + mesh_.begins[k], all + mesh_.begins[k + 1]};
  }
  void look(SimplexPair kind, const int* particles) {
    const double kept =
        sheet_pairs::kNearShare * sheet_pairs::rest_distance(joints_, kind, particles);
    if (kept > 0.0) least_ = std::min(least_, kept);
  }

  const SheetMesh& mesh_;
  SheetJoints joints_;
  double least_;
};

}  // namespace

double least_thickness(const SheetMesh& mesh, double thickness) {
  const int vertices = mesh.vertices(), edges = static_cast<int>(mesh.edges.cols());
  return parallel_reduce(
      0, vertices + edges, kGrain,
      [&](int begin, int end) {
        LeastThickness part(mesh, thickness);
        for (int k = begin; k < end; ++k) {
          k < vertices ? part.look_at_vertex(k) : part.look_at_edge(k - vertices);
        }
        return part.least();
      },
      [](double a, double b) { return std::min(a, b); });
}

}  // namespace pliant
