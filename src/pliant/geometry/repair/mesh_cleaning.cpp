#include "pliant/geometry/repair/mesh_cleaning.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/mesh/vertex_welder.h"
#include "pliant/geometry/repair/orientation.h"
#include "pliant/geometry/search/point_hash.h"

namespace pliant {
namespace {

constexpr double kNear = 1e-5;  // of the mesh's longest side

using Side = std::array<int, 2>;

std::vector<Side> sorted_edges(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * static_cast<std::size_t>(mesh.triangles.cols()));
  for (const auto t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      sides.push_back({low, high});
    }
  }
  std::sort(sides.begin(), sides.end());
  return sides;
}

/// Calls visit(edge, number of its triangles) for each edge.
template <class Visit>
void for_each_edge(const TriangleMesh& mesh, const Visit& visit) {
  const std::vector<Side> sides = sorted_edges(mesh);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end] == sides[begin]) ++end;
    visit(sides[begin], static_cast<int>(end - begin));
  }
}

TriangleMesh with_vertices_of(const TriangleMesh& mesh, const std::vector<int>& same_as) {
  TriangleMesh result = mesh;
  for (int& v : result.triangles.reshaped()) v = same_as[static_cast<std::size_t>(v)];
  return result;
}

TriangleMesh welded(const TriangleMesh& mesh) {
  VertexWelder welder;
  std::vector<int> place;
  for (const auto v : mesh.vertices.colwise()) place.push_back(welder.add(v));
  TriangleMesh result = with_vertices_of(mesh, place);
  result.vertices = welder.vertices();
  return result;
}

/// Cracks: each vertex of an open edge takes the first one's place that is near it.
TriangleMesh without_cracks(const TriangleMesh& mesh, int& joined) {
  std::vector<char> is_open(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for_each_edge(mesh, [&](const Side& edge, int triangles) {
    if (triangles == 1) is_open[edge[0]] = is_open[edge[1]] = 1;
  });
  std::vector<int> open;
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    if (is_open[v] != 0) open.push_back(v);
  }
  if (open.empty()) return mesh;
  const Eigen::Vector3d size =
      mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff();
  const double near = kNear * size.maxCoeff();
  if (!(near > 0.0)) return mesh;
  const Eigen::Vector3d low = mesh.vertices.rowwise().minCoeff();
  const Eigen::Matrix3Xd points = mesh.vertices(Eigen::all, open).colwise() - low;
  PointHash hash;
  hash.build(points, 4.0 * near);
  std::vector<int> same_as(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(same_as.begin(), same_as.end(), 0);
  for (int k = 0; k < static_cast<int>(open.size()); ++k) {
    if (same_as[open[k]] != open[k]) continue;
    const Eigen::Vector3d p = points.col(k);
    const Eigen::AlignedBox3d box(p.array() - near, p.array() + near);
    hash.for_each_near(box, [&](int other) {
      const bool is_later = other > k && same_as[open[other]] == open[other];
      if (!is_later || (points.col(other) - p).norm() > near) return;
      same_as[open[other]] = open[k];
      ++joined;
    });
  }
  return with_vertices_of(mesh, same_as);
}

TriangleMesh with_triangles(const TriangleMesh& mesh, const std::vector<int>& kept) {
  TriangleMesh result;
  std::vector<int> place(static_cast<std::size_t>(mesh.vertices.cols()), -1), used;
  result.triangles = mesh.triangles(Eigen::all, kept);
  for (int& v : result.triangles.reshaped()) {
    int& at = place[static_cast<std::size_t>(v)];
    if (at < 0) {
      at = static_cast<int>(used.size());
      used.push_back(v);
    }
    v = at;
  }
  result.vertices = mesh.vertices(Eigen::all, used);
  return result;
}

/// The first of all that have the same corners; none of those that have one corner twice.
TriangleMesh without_repetitions(const TriangleMesh& mesh, MeshCleaning& done) {
  std::vector<std::array<int, 4>> sorted;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    std::array<int, 4> key = {mesh.triangles(0, t), mesh.triangles(1, t), mesh.triangles(2, t), t};
    std::sort(key.begin(), key.begin() + 3);
    if (key[0] == key[1] || key[1] == key[2]) {
      ++done.degenerate;
    } else {
      sorted.push_back(key);
    }
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<int> kept;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i > 0 && std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin())) {
      ++done.repeated;
    } else {
      kept.push_back(sorted[i][3]);
    }
  }
  std::sort(kept.begin(), kept.end());
  return with_triangles(mesh, kept);
}

}  // namespace

int count_edges(const TriangleMesh& mesh, int least, int most) {
  int count = 0;
  for_each_edge(mesh, [&](const Side&, int triangles) {
    count += triangles >= least && triangles <= most ? 1 : 0;
  });
  return count;
}

int count_opposed(const TriangleMesh& mesh) {
  int count = 0;
  for (const TriangleNeighbours& pair : triangle_neighbours(mesh)) count += pair.opposed ? 1 : 0;
  return count;
}

TriangleMesh clean_mesh(const TriangleMesh& mesh, MeshCleaning& done) {
  const TriangleMesh joined = without_cracks(without_repetitions(welded(mesh), done), done.joined);
  const TriangleMesh distinct = without_repetitions(joined, done);
  std::vector<int> kept;
  for (int t = 0; t < distinct.triangles.cols(); ++t) {
    if (!is_degenerate(distinct, t)) kept.push_back(t);
  }
  if (static_cast<Eigen::Index>(kept.size()) == distinct.triangles.cols()) return distinct;
  TriangleMesh with_area = with_triangles(distinct, kept);
  const auto uneven = [](const TriangleMesh& some) {
    return count_edges(some, 1, 1) + count_edges(some, 3, kMaxTriangles);
  };
  if (uneven(with_area) > uneven(distinct)) return distinct;
  done.degenerate += static_cast<int>(distinct.triangles.cols() - with_area.triangles.cols());
  return with_area;
}

}  // namespace pliant
