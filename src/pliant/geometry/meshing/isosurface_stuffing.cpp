#include "pliant/geometry/meshing/isosurface_stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pliant/geometry/meshing/lattice.h"
#include "pliant/geometry/meshing/stuffing_stencils.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

enum Side : signed char { kOutside = -1, kOn = 0, kInside = 1 };

/// Warps a lattice to the zero of its distances, then replaces each tetrahedron by what of it lies
/// inside (section 3 of the paper).
class Stuffing {
 public:
  explicit Stuffing(const DistanceGrid& grid)
      : lattice_(grid), side_(grid.samples.size(), kOutside), vertex_(grid.samples.size(), kNone) {
    for (std::size_t i = 0; i < grid.samples.size(); ++i) {
      if (grid.samples[i] < 0.0f) side_[i] = kInside;
    }
  }

  TetrahedralMesh run() {
    for (const int point : lattice_.inner_points()) warp(point);
    StuffingStencils<Stuffing> stencils(*this, tetrahedra_);
    lattice_.visit_tetrahedra(
        [this](const std::array<int, 4>& points) {
          return std::any_of(points.begin(), points.end(),
                             [this](int p) { return side(p) == kInside; });
        },
        [&stencils](const std::array<int, 4>& points) { stencils.add_inside_of(points); });
    return mesh();
  }

  // What the stencils ask of the lattice's points.

  int sign(int point) const { return side(point); }
  bool is_long(int a, int b) const { return lattice_.is_long(a, b); }
  Eigen::Array3i coordinates(int point) const { return lattice_.coordinates(point); }

  int corner(int point) {
    int& vertex = vertex_[static_cast<std::size_t>(point)];
    if (vertex == kNone) {
      const auto moved = warped_.find(point);
      vertex = add_vertex(moved == warped_.end() ? lattice_.position(point) : moved->second);
    }
    return vertex;
  }

  int cut(int inside, int outside) {
    const std::uint64_t key =
        static_cast<std::uint64_t>(inside) << 32 | static_cast<std::uint64_t>(outside);
    const auto [place, is_new] = cuts_.try_emplace(key, kNone);
    if (is_new) place->second = add_vertex(cut_position(inside, outside));
    return place->second;
  }

 private:
  static constexpr int kNone = -1;

  Side side(int point) const { return side_[static_cast<std::size_t>(point)]; }

  /// Where the edge crosses the surface, 0 at a to 1 at b, the distance being linear between them.
  double cut_at(int a, int b) const {
    const double from = lattice_.distance(a), to = lattice_.distance(b);
    return from / (from - to);
  }

  /// Moves a point that a cut point violates onto the nearest one of those.
  void warp(int point) {
    double nearest = 1.0;
    int towards = kNone;
    for (int k = 0; k < Lattice::kNeighbours; ++k) {
      const int other = lattice_.neighbour(point, k);
      if (side(point) * side(other) != -1) continue;
      const bool is_short = k < Lattice::kShortNeighbours;
      const double share = cut_at(point, other);
      if (share >= (is_short ? kAlphaShort : kAlphaLong)) continue;
      const double distance = share * (is_short ? std::sqrt(0.75) : 1.0);
      if (distance >= nearest) continue;
      nearest = distance;
      towards = other;
    }
    if (towards == kNone) return;
    warped_[point] = cut_position(point, towards);
    side_[static_cast<std::size_t>(point)] = kOn;
  }

  Vector3d cut_position(int a, int b) const {
    const Vector3d from = lattice_.position(a);
    return from + cut_at(a, b) * (lattice_.position(b) - from);
  }

  int add_vertex(const Vector3d& position) {
    positions_.push_back(position);
    return static_cast<int>(positions_.size()) - 1;
  }

  TetrahedralMesh mesh() const {
    TetrahedralMesh result;
    result.vertices.resize(3, static_cast<Eigen::Index>(positions_.size()));
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      result.vertices.col(static_cast<Eigen::Index>(v)) = positions_[v];
    }
    result.tetrahedra.resize(4, static_cast<Eigen::Index>(tetrahedra_.size()));
    for (std::size_t t = 0; t < tetrahedra_.size(); ++t) {
      const auto& corners = tetrahedra_[t];
      result.tetrahedra.col(static_cast<Eigen::Index>(t)) << corners[0], corners[1], corners[2],
          corners[3];
    }
    fix_winding(result);  // the stencils are right for either of two mirror images
    return result;
  }

  Lattice lattice_;
  std::vector<Side> side_;
  std::vector<int> vertex_;  ///< of each point, or kNone
  std::unordered_map<int, Vector3d> warped_;
  std::unordered_map<std::uint64_t, int> cuts_;  ///< vertex of each cut edge
  std::vector<Vector3d> positions_;
  std::vector<CornerTetrahedron> tetrahedra_;
};

}  // namespace

TetrahedralMesh stuff_negative(const DistanceGrid& grid) { return Stuffing(grid).run(); }

}  // namespace pliant
