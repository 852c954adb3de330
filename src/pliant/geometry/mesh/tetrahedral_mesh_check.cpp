#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pliant/geometry/mesh/offenders.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"
#include "pliant/geometry/mesh/tetrahedron_faces.h"

namespace pliant {
namespace {

constexpr double kLeastTetrahedronHeight = 1e-10;  // of a tetrahedron, relative to its longest edge

void check_size(const TetrahedralMesh& mesh, const std::string& where) {
  if (mesh.vertices.cols() == 0) throw InputError(where + ": the mesh has no vertices");
  if (mesh.tetrahedra.cols() == 0) throw InputError(where + ": the mesh has no tetrahedra");
  if (mesh.tetrahedra.cols() > kMaxTetrahedra) {
    throw InputError(fmt::format("{}: the mesh has {} tetrahedra: at most {} are allowed", where,
                                 mesh.tetrahedra.cols(), kMaxTetrahedra));
  }
}

void check_numbers(const TetrahedralMesh& mesh, const std::string& where) {
  Offenders not_finite, out_of_range;
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    if (!mesh.vertices.col(v).allFinite()) not_finite.add(v);
  }
  not_finite.refuse(where, "vertices are not finite");
  for (int t = 0; t < mesh.tetrahedra.cols(); ++t) {
    const auto v = mesh.tetrahedra.col(t);
    if (v.minCoeff() < 0 || v.maxCoeff() >= mesh.vertices.cols()) out_of_range.add(t);
  }
  out_of_range.refuse(
      where, fmt::format("tetrahedra name vertices outside [0, {}]", mesh.vertices.cols() - 1));
}

/// Least height over longest edge, negative for an inverted tetrahedron, 0 for one without edges.
double relative_height(const TetrahedralMesh& mesh, int tetrahedron) {
  const Eigen::Vector4i v = mesh.tetrahedra.col(tetrahedron);
  double longest = 0.0;
  for (int k = 0; k < 4; ++k) {
    for (int l = 0; l < k; ++l) {
      const Eigen::Vector3d edge = mesh.vertices.col(v[k]) - mesh.vertices.col(v[l]);
      longest = std::max(longest, edge.stableNorm());
    }
  }
  if (!(longest > 0.0) || !std::isfinite(longest)) return 0.0;
  std::array<Eigen::Vector3d, 4> x;  // scaled, so that tiny and huge ones are judged alike
  for (int k = 0; k < 4; ++k) {
    x[static_cast<std::size_t>(k)] = (mesh.vertices.col(v[k]) - mesh.vertices.col(v[0])) / longest;
  }
  const double six_volumes = x[1].cross(x[2]).dot(x[3]);
  double largest = 0.0;  // twice a face's area
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d &a = x[k], &b = x[(k + 1) % 4], &c = x[(k + 2) % 4];
    largest = std::max(largest, (b - a).cross(c - a).norm());
  }
  return largest > 0.0 ? six_volumes / largest : 0.0;
}

void check_shapes(const TetrahedralMesh& mesh, const std::string& where) {
  Offenders flat, inverted;
  for (int t = 0; t < mesh.tetrahedra.cols(); ++t) {
    const double height = relative_height(mesh, t);
    if (std::abs(height) < kLeastTetrahedronHeight) {
      flat.add(t);
    } else if (height < 0.0) {
      inverted.add(t);
    }
  }
  flat.refuse(where, "tetrahedra are flat (no volume); remove them or mesh the body anew");
  inverted.refuse(where,
                  "tetrahedra are inverted (negative volume); fix_winding() mends them if only "
                  "their vertices' order is wrong");
}

void check_duplicates(const TetrahedralMesh& mesh, const std::string& where) {
  Offenders duplicates;
  const auto count = static_cast<std::size_t>(mesh.tetrahedra.cols());
  std::vector<std::array<int, 5>> sorted(count);
  for (std::size_t t = 0; t < count; ++t) {
    const Eigen::Vector4i v = mesh.tetrahedra.col(static_cast<Eigen::Index>(t));
    sorted[t] = {v[0], v[1], v[2], v[3], static_cast<int>(t)};
    std::sort(sorted[t].begin(), sorted[t].begin() + 4);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t t = 1; t < count; ++t) {
    if (std::equal(sorted[t].begin(), sorted[t].begin() + 4, sorted[t - 1].begin())) {
      duplicates.add(sorted[t][4]);
    }
  }
  duplicates.refuse(where, "tetrahedra repeat another one; remove them");
}

void check_all_used(const TetrahedralMesh& mesh, const std::string& where) {
  std::vector<char> used(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const auto tetrahedron : mesh.tetrahedra.colwise()) {
    for (int k = 0; k < 4; ++k) used[static_cast<std::size_t>(tetrahedron[k])] = 1;
  }
  Offenders unused;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) unused.add(static_cast<int>(v));
  }
  unused.refuse(where, "vertices are in no tetrahedron and would have no mass; remove them");
}

void check_faces(const TetrahedralMesh& mesh, const std::string& where) {
  Offenders crowded, overlapping;
  const std::vector<TetrahedronFace> faces = sorted_faces(mesh.tetrahedra);
  for (std::size_t first = 0; first < faces.size();) {
    const std::size_t end = end_of_same_face(faces, first);
    if (end - first > 2) crowded.add(faces[end - 1].tetrahedron);
    if (end - first == 2 && faces[first].even == faces[first + 1].even) {
      overlapping.add(faces[first + 1].tetrahedron);
    }
    first = end;
  }
  crowded.refuse(where, "tetrahedra share a face with two others; remove what overlaps");
  overlapping.refuse(where,
                     "tetrahedra overlap a neighbour (both on the same side of their common "
                     "face); the mesh folds over itself there");
}

}  // namespace

void validate(const TetrahedralMesh& mesh, const std::string& where) {
  check_size(mesh, where);
  check_numbers(mesh, where);
  check_shapes(mesh, where);
  check_duplicates(mesh, where);
  check_all_used(mesh, where);
  check_faces(mesh, where);
}

}  // namespace pliant
