#include "pliant/geometry/patch/patch_polygons.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <map>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Numbers the points of all patches' grids, those on shared edges once.
class GridNumbers {
 public:
  GridNumbers(const PatchBody& body, int level)
      : body_(body), level_(level), vertices_(static_cast<int>(body.base.vertices.cols())) {
    for (std::size_t e = 0; e < body.edges.size(); ++e) edge_[body.edges[e]] = static_cast<int>(e);
    first_within_ = vertices_ + static_cast<int>(body.edges.size()) * (level - 1);
  }

  int count() const {
    const int within = (level_ - 1) * (level_ - 2) / 2;
    return first_within_ + static_cast<int>(body_.base.triangles.cols()) * within;
  }

  /// Of the point with barycentric coordinates at / level.
  int operator()(int patch, const Eigen::Vector3i& at) const {
    const auto corners = body_.base.triangles.col(patch);
    for (int k = 0; k < 3; ++k) {
      if (at[k] == level_) return corners[k];
    }
    for (int k = 0; k < 3; ++k) {
      if (at[k] != 0) continue;
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const bool rises = corners[a] < corners[b];
      const int edge =
          rises ? edge_.at({corners[a], corners[b]}) : edge_.at({corners[b], corners[a]});
      return vertices_ + edge * (level_ - 1) + (rises ? at[b] : at[a]) - 1;
    }
    // Rows of constant at[0] = 1, 2, ..., each one shorter than the last.
    const int row = at[0] - 1;
    const int before = row * (level_ - 2) - row * (row - 1) / 2;
    return first_within_ + patch * ((level_ - 1) * (level_ - 2) / 2) + before + at[1] - 1;
  }

 private:
  const PatchBody& body_;
  int level_;
  int vertices_;
  int first_within_;
  std::map<std::array<int, 2>, int> edge_;
};

void check_level(const PatchSurface& surface, int level) {
  if (level < 1 || level > kMaxPatchLevel) {
    throw InputError(
        fmt::format("level of detail is {}: allowed is [1, {}]", level, kMaxPatchLevel));
  }
  const double triangles = static_cast<double>(surface.patches()) * level * level;
  if (triangles > kMaxTriangles) {
    throw InputError(
        fmt::format("level of detail {} (surface_level) makes {:.3g} triangles: at most {} are "
                    "allowed, [1, {:.0f}] for these {} patches",
                    level, triangles, kMaxTriangles,
                    std::floor(std::sqrt(kMaxTriangles / static_cast<double>(surface.patches()))),
                    surface.patches()));
  }
}

}  // namespace

PatchPolygons polygonise(const PatchSurface& surface, int level) {
  check_level(surface, level);
  const GridNumbers number(surface.body(), level);
  PatchPolygons result;
  result.mesh.vertices.resize(3, number.count());
  result.mesh.triangles.resize(3, surface.patches() * level * level);
  result.patch = Eigen::VectorXi::Constant(number.count(), -1);
  result.barycentric.resize(3, number.count());
  int next = 0;
  for (int patch = 0; patch < surface.patches(); ++patch) {
    for (int i = 0; i <= level; ++i) {
      for (int j = 0; i + j <= level; ++j) {
        const Eigen::Vector3i at(i, j, level - i - j);
        const int here = number(patch, at);
        if (result.patch[here] < 0) {
          result.patch[here] = patch;
          result.barycentric.col(here) = at.cast<double>() / level;
        }
        if (at[2] == 0) continue;
        const int right = number(patch, {i + 1, j, at[2] - 1});
        const int up = number(patch, {i, j + 1, at[2] - 1});
        result.mesh.triangles.col(next++) << right, up, here;
        if (at[2] == 1) continue;
        result.mesh.triangles.col(next++) << up, right, number(patch, {i + 1, j + 1, at[2] - 2});
      }
    }
  }
  for (int v = 0; v < number.count(); ++v) {
    result.mesh.vertices.col(v) = surface.point(result.patch[v], result.barycentric.col(v));
  }
  return result;
}

}  // namespace pliant
