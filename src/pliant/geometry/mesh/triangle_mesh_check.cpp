#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/mesh/offenders.h"
#include "pliant/geometry/mesh/triangle_mesh.h"
#include "pliant/geometry/repair/orientation.h"
#include "pliant/math/error.h"

namespace pliant {

bool is_degenerate(const TriangleMesh& mesh, int triangle) {
  constexpr double kLeastHeight = 1e-10;
  const Eigen::Vector3i t = mesh.triangles.col(triangle);
  Eigen::Vector3d u = mesh.vertices.col(t[1]) - mesh.vertices.col(t[0]);
  Eigen::Vector3d v = mesh.vertices.col(t[2]) - mesh.vertices.col(t[0]);
  const double longest = std::max({u.stableNorm(), v.stableNorm(), (v - u).stableNorm()});
  if (!(longest > 0.0) || !std::isfinite(longest)) return true;
  u /= longest;  // so that tiny and huge triangles are judged alike
  v /= longest;
  return u.cross(v).norm() < kLeastHeight;
}

namespace {

std::string size_fault(const TriangleMesh& mesh) {
  if (mesh.vertices.cols() == 0) return "the mesh has no vertices";
  if (mesh.triangles.cols() == 0) return "the mesh has no triangles";
  if (mesh.triangles.cols() <= kMaxTriangles) return "";
  return fmt::format("the mesh has {} triangles: at most {} are allowed", mesh.triangles.cols(),
                     kMaxTriangles);
}

void add_fault(const std::string& fault, std::vector<std::string>& faults) {
  if (!fault.empty()) faults.push_back(fault);
}

// Whether triangles name vertices that are not there.
bool add_number_faults(const TriangleMesh& mesh, std::vector<std::string>& faults) {
  Offenders not_finite, out_of_range;
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    if (!mesh.vertices.col(v).allFinite()) not_finite.add(v);
  }
  add_fault(not_finite.text("vertices are not finite"), faults);
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto triangle = mesh.triangles.col(t);
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= mesh.vertices.cols()) out_of_range.add(t);
  }
  add_fault(out_of_range.text(
                fmt::format("triangles name vertices outside [0, {}]", mesh.vertices.cols() - 1)),
            faults);
  return !out_of_range.empty();
}

void add_triangle_faults(const TriangleMesh& mesh, std::vector<std::string>& faults) {
  Offenders degenerates, duplicates;
  const int count = static_cast<int>(mesh.triangles.cols());
  std::vector<std::array<int, 4>> sorted(count);
  for (int t = 0; t < count; ++t) {
    if (is_degenerate(mesh, t)) degenerates.add(t);
    const auto triangle = mesh.triangles.col(t);
    sorted[t] = {triangle[0], triangle[1], triangle[2], t};
    std::sort(sorted[t].begin(), sorted[t].begin() + 3);
  }
  add_fault(degenerates.text("triangles are degenerate (no area)"), faults);
  std::sort(sorted.begin(), sorted.end());
  for (int i = 1; i < count; ++i) {
    if (std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin())) {
      duplicates.add(sorted[i][3]);
    }
  }
  add_fault(duplicates.text("triangles repeat another one"), faults);
}

std::string unused_vertices(const TriangleMesh& mesh) {
  std::vector<char> used(mesh.vertices.cols(), 0);
  for (const auto triangle : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) used[triangle[k]] = 1;
  }
  Offenders unused;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) unused.add(static_cast<int>(v));
  }
  return unused.text("vertices are in no triangle");
}

// The first edge with more than two triangles, as edges() names it, and how many more there are.
std::string crowded_edges(const TriangleMesh& mesh) {
  std::map<std::array<int, 2>, int> triangles;
  for (const auto t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      ++triangles[{low, high}];
    }
  }
  std::string first;
  int count = 0;
  for (const auto& [edge, sharing] : triangles) {
    if (sharing <= 2 || ++count > 1) continue;
    first = fmt::format(
        "the edge between vertices {} and {} has {} triangles: at most 2 are "
        "allowed",
        edge[0], edge[1], sharing);
  }
  return count < 2 ? first : fmt::format("{} (and {} edges more)", first, count - 1);
}

}  // namespace

std::vector<std::string> mesh_faults(const TriangleMesh& mesh) {
  std::vector<std::string> faults;
  add_fault(size_fault(mesh), faults);
  if (!faults.empty()) return faults;
  const bool names_no_vertex = add_number_faults(mesh, faults);
  if (names_no_vertex) return faults;  // nothing can be said of triangles without corners
  add_triangle_faults(mesh, faults);
  add_fault(unused_vertices(mesh), faults);
  add_fault(crowded_edges(mesh), faults);
  Offenders opposed;
  for (const TriangleNeighbours& pair : triangle_neighbours(mesh)) {
    if (pair.opposed) opposed.add(pair.triangles[1]);
  }
  add_fault(opposed.text("triangles wind the other way than a neighbour"), faults);
  return faults;
}

void validate(const TriangleMesh& mesh, const std::string& where) {
  const std::vector<std::string> faults = mesh_faults(mesh);
  if (!faults.empty()) throw InputError(fmt::format("{}: {}", where, fmt::join(faults, "; ")));
}

bool orient_consistently(TriangleMesh& mesh) {
  edges(mesh);  // refuses what has no two sides
  OrientationUnion sets(static_cast<int>(mesh.triangles.cols()));
  for (const TriangleNeighbours& pair : triangle_neighbours(mesh)) {
    if (!sets.relate(pair.triangles[0], pair.triangles[1], pair.opposed)) return false;
  }
  orient_by_majority(sets, mesh);
  return true;
}

}  // namespace pliant
