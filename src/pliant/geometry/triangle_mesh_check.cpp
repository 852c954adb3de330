#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "pliant/geometry/offenders.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {
namespace {

constexpr double kLeastHeight = 1e-10;  // of a triangle, relative to its longest edge

void check_size(const TriangleMesh& mesh, const std::string& where) {
  if (mesh.vertices.cols() == 0) throw InputError(where + ": the mesh has no vertices");
  if (mesh.triangles.cols() == 0) throw InputError(where + ": the mesh has no triangles");
  if (mesh.triangles.cols() > kMaxTriangles) {
    throw InputError(fmt::format("{}: the mesh has {} triangles: at most {} are allowed", where,
                                 mesh.triangles.cols(), kMaxTriangles));
  }
}

void check_numbers(const TriangleMesh& mesh, const std::string& where) {
  Offenders not_finite, out_of_range;
  for (int v = 0; v < mesh.vertices.cols(); ++v) {
    if (!mesh.vertices.col(v).allFinite()) not_finite.add(v);
  }
  not_finite.refuse(where, "vertices are not finite");
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const auto triangle = mesh.triangles.col(t);
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= mesh.vertices.cols()) out_of_range.add(t);
  }
  out_of_range.refuse(
      where, fmt::format("triangles name vertices outside [0, {}]", mesh.vertices.cols() - 1));
}

bool degenerate(const TriangleMesh& mesh, int triangle) {
  const Eigen::Vector3i t = mesh.triangles.col(triangle);
  Eigen::Vector3d u = mesh.vertices.col(t[1]) - mesh.vertices.col(t[0]);
  Eigen::Vector3d v = mesh.vertices.col(t[2]) - mesh.vertices.col(t[0]);
  const double longest = std::max({u.stableNorm(), v.stableNorm(), (v - u).stableNorm()});
  if (!(longest > 0.0) || !std::isfinite(longest)) return true;
  u /= longest;  // so that tiny and huge triangles are judged alike
  v /= longest;
  return u.cross(v).norm() < kLeastHeight;
}

void check_triangles(const TriangleMesh& mesh, const std::string& where) {
  Offenders degenerates, duplicates;
  const int count = static_cast<int>(mesh.triangles.cols());
  std::vector<std::array<int, 4>> sorted(count);
  for (int t = 0; t < count; ++t) {
    if (degenerate(mesh, t)) degenerates.add(t);
    const auto triangle = mesh.triangles.col(t);
    sorted[t] = {triangle[0], triangle[1], triangle[2], t};
    std::sort(sorted[t].begin(), sorted[t].begin() + 3);
  }
  degenerates.refuse(where, "triangles are degenerate (no area)");
  std::sort(sorted.begin(), sorted.end());
  for (int i = 1; i < count; ++i) {
    if (std::equal(sorted[i].begin(), sorted[i].begin() + 3, sorted[i - 1].begin())) {
      duplicates.add(sorted[i][3]);
    }
  }
  duplicates.refuse(where, "triangles repeat another one");
}

void check_all_used(const TriangleMesh& mesh, const std::string& where) {
  std::vector<char> used(mesh.vertices.cols(), 0);
  for (const auto triangle : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) used[triangle[k]] = 1;
  }
  Offenders unused;
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) unused.add(static_cast<int>(v));
  }
  unused.refuse(where, "vertices are in no triangle");
}

// Two triangles that share an edge, and whether both run along it in the same direction.
struct Neighbours {
  int triangles[2];
  bool opposed;
};

struct Side {
  int low, high;  // vertices
  int triangle;
  bool rising;
};

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.cols());
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles(k, t);
      const int b = mesh.triangles((k + 1) % 3, t);
      sides.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& l, const Side& r) {
    return std::array{l.low, l.high, l.triangle} < std::array{r.low, r.high, r.triangle};
  });
  return sides;
}

std::vector<Neighbours> neighbours(const TriangleMesh& mesh) {
  std::vector<Neighbours> result;
  const std::vector<Side> sides = sorted_sides(mesh);
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const Side& a = sides[i - 1];
    const Side& b = sides[i];
    if (a.low != b.low || a.high != b.high) continue;
    result.push_back({{a.triangle, b.triangle}, a.rising == b.rising});
  }
  return result;
}

// Union-find that also knows whether a member is flipped relative to its root.
class Orientation {
 public:
  explicit Orientation(int count) : parent_(count), flipped_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int root(int member) {
    int top = member;
    char flip = 0;
    for (; parent_[top] != top; top = parent_[top]) flip ^= flipped_[top];
    while (parent_[member] != top && member != top) {
      const int next = parent_[member];
      const char rest = flip ^ flipped_[member];
      parent_[member] = top;
      flipped_[member] = flip;
      flip = rest;
      member = next;
    }
    return top;
  }

  bool flipped(int member) {
    root(member);
    return flipped_[member] != 0;
  }

  // Says that a and b are opposed or not; false when that contradicts what was said before.
  bool relate(int a, int b, bool opposed) {
    const int root_a = root(a);
    const int root_b = root(b);
    const bool flip = opposed != (flipped(a) != flipped(b));
    if (root_a == root_b) return !flip;
    // The smaller triangle stays the root, so that it decides a draw.
    parent_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    flipped_[std::max(root_a, root_b)] = flip ? 1 : 0;
    return true;
  }

 private:
  std::vector<int> parent_;
  std::vector<char> flipped_;  // relative to the parent
};

}  // namespace

void validate(const TriangleMesh& mesh, const std::string& where) {
  check_size(mesh, where);
  check_numbers(mesh, where);
  check_triangles(mesh, where);
  check_all_used(mesh, where);
  try {
    edges(mesh);
  } catch (const InputError& error) {
    throw InputError(where + ": " + error.what());
  }
  Offenders opposed;
  for (const Neighbours& pair : neighbours(mesh)) {
    if (pair.opposed) opposed.add(pair.triangles[1]);
  }
  opposed.refuse(where, "triangles wind the other way than a neighbour");
}

bool orient_consistently(TriangleMesh& mesh) {
  edges(mesh);  // refuses what has no two sides
  const int count = static_cast<int>(mesh.triangles.cols());
  Orientation orientation(count);
  for (const Neighbours& pair : neighbours(mesh)) {
    if (!orientation.relate(pair.triangles[0], pair.triangles[1], pair.opposed)) return false;
  }
  std::vector<int> balance(count,
                           0);  // of each part's root: members that agree less those that do not
  for (int t = 0; t < count; ++t) {
    balance[orientation.root(t)] += orientation.flipped(t) ? -1 : 1;
  }
  for (int t = 0; t < count; ++t) {
    const bool root_is_wrong = balance[orientation.root(t)] < 0;
    if (orientation.flipped(t) != root_is_wrong) {
      std::swap(mesh.triangles(1, t), mesh.triangles(2, t));
    }
  }
  return true;
}

}  // namespace pliant
