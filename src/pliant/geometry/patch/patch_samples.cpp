#include "pliant/geometry/patch/patch_samples.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pliant/geometry/meshing/spaced_points.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

/// In a base vertex a patch's normal is its triangle's: the shape's is that a little beside it.
constexpr double kBeside = 1e-3;

struct Place {
  int patch;
  Vector3d barycentric;
};

class Sampler {
 public:
  Sampler(const PatchSurface& surface, double spacing)
      : surface_(surface),
        base_(surface.body().base),
        grid_(kSampleGrid * spacing),
        spaced_(kSampleDistance * spacing),
        edge_done_(surface.body().edges.size(), 0) {}

  PatchSamples run() {
    add_vertices();
    const int vertices = static_cast<int>(places_.size());
    for (int patch = 0; patch < surface_.patches(); ++patch) {
      for (int opposite = 0; opposite < 3; ++opposite) add_edge(patch, opposite);
    }
    for (int patch = 0; patch < surface_.patches(); ++patch) add_within(patch);
    return samples(vertices);
  }

 private:
  int corner(int patch, int k) const { return base_.triangles(k % 3, patch); }

  double length(int patch, int k) const {
    return (base_.vertices.col(corner(patch, k)) - base_.vertices.col(corner(patch, k + 1))).norm();
  }

  void add_vertices() {
    std::vector<char> done(static_cast<std::size_t>(base_.vertices.cols()), 0);
    places_.resize(done.size());
    for (int patch = 0; patch < surface_.patches(); ++patch) {
      for (int k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(corner(patch, k));
        if (done[v] != 0) continue;
        done[v] = 1;
        places_[v] = {patch, Vector3d::Unit(k)};
        spaced_.force(base_.vertices.col(corner(patch, k)));
      }
    }
  }

  void add_edge(int patch, int opposite) {
    const int a = (opposite + 1) % 3, b = (opposite + 2) % 3;
    const std::array<int, 2> edge = {std::min(corner(patch, a), corner(patch, b)),
                                     std::max(corner(patch, a), corner(patch, b))};
    const auto& all = surface_.body().edges;
    const auto index = std::lower_bound(all.begin(), all.end(), edge) - all.begin();
    if (edge_done_[static_cast<std::size_t>(index)] != 0) return;
    edge_done_[static_cast<std::size_t>(index)] = 1;
    const int parts = cuts(length(patch, a));
    for (int i = 1; i < parts; ++i) {
      Vector3d at = Vector3d::Zero();
      at[b] = static_cast<double>(i) / parts;
      at[a] = 1.0 - at[b];
      add(patch, at);
    }
  }

  void add_within(int patch) {
    const int parts = cuts(std::max({length(patch, 0), length(patch, 1), length(patch, 2)}));
    for (int i = 1; i < parts; ++i) {
      for (int j = 1; i + j < parts; ++j) {
        add(patch, Vector3d(i, j, parts - i - j) / parts);
      }
    }
  }

  void add(int patch, const Vector3d& at) {
    if (spaced_.keep(surface_.point(patch, at))) places_.push_back({patch, at});
  }

  int cuts(double length) const {
    return std::max(1, static_cast<int>(std::ceil(length / grid_ * (1.0 - 1e-12))));
  }

  Vector3d vertex_normal(int vertex) const { return vertex_normals_.col(vertex).normalized(); }

  void find_vertex_normals() {
    vertex_normals_ = Eigen::Matrix3Xd::Zero(3, base_.vertices.cols());
    for (int patch = 0; patch < surface_.patches(); ++patch) {
      for (int k = 0; k < 3; ++k) {
        Vector3d at = Vector3d::Constant(kBeside);
        at[k] = 1.0 - 2.0 * kBeside;
        vertex_normals_.col(corner(patch, k)) += surface_.normal(patch, surface_.point(patch, at));
      }
    }
  }

  PatchSamples samples(int vertices) {
    find_vertex_normals();
    const auto count = static_cast<Eigen::Index>(places_.size());
    PatchSamples result;
    result.points.resize(3, count);
    result.normals.resize(3, count);
    result.patch.resize(count);
    result.barycentric.resize(3, count);
    for (int i = 0; i < count; ++i) {
      const Place& place = places_[static_cast<std::size_t>(i)];
      result.points.col(i) = surface_.point(place.patch, place.barycentric);
      result.normals.col(i) =
          i < vertices ? vertex_normal(i) : surface_.normal(place.patch, result.points.col(i));
      result.patch[i] = place.patch;
      result.barycentric.col(i) = place.barycentric;
    }
    return result;
  }

  const PatchSurface& surface_;
  const TriangleMesh& base_;
  double grid_;
  SpacedPoints spaced_;
  std::vector<char> edge_done_;
  std::vector<Place> places_;
  Eigen::Matrix3Xd vertex_normals_;
};

}  // namespace

PatchSamples sample_points(const PatchSurface& surface, double spacing) {
  if (!(spacing > 0.0 && std::isfinite(spacing))) {
    throw InputError(fmt::format("spacing is {} m: allowed is any length > 0", spacing));
  }
  // About half a square of the spacing a point, over each triangle's longest edge.
  double count = 0.0;
  const TriangleMesh& base = surface.body().base;
  for (const auto t : base.triangles.colwise()) {
    double longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      longest =
          std::max(longest, (base.vertices.col(t[k]) - base.vertices.col(t[(k + 1) % 3])).norm());
    }
    count += 0.5 * std::pow(longest / spacing, 2);
  }
  if (count > kMaxTriangles) {
    throw InputError(
        fmt::format("spacing {} m asks for about {:.3g} points: at most {} are allowed: take a "
                    "contact_spacing of about {:.2g} m or more",
                    spacing, count, kMaxTriangles, spacing * std::sqrt(count / kMaxTriangles)));
  }
  return Sampler(surface, spacing).run();
}

}  // namespace pliant
