#include "pliant/geometry/meshing/isosurface_stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pliant/geometry/mesh/stencils.h"
#include "pliant/geometry/meshing/lattice.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

// A cut point nearer to a lattice point than that share of the edge moves the point onto the
// surface. Of the values tried, these kept the least dihedral angle greatest in 400 grids of noise
// made to come near them (10.6 degrees; the paper's 0.41189 and 0.24999 gave 9.7 here).
constexpr double kAlphaShort = 0.39;
constexpr double kAlphaLong = 0.25;

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
    lattice_.visit_tetrahedra(
        [this](const std::array<int, 4>& points) {
          return std::any_of(points.begin(), points.end(),
                             [this](int p) { return side(p) == kInside; });
        },
        [this](const std::array<int, 4>& points) { add_inside_of(points); });
    return mesh();
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
      const double way = share * (is_short ? std::sqrt(0.75) : 1.0);
      if (way >= nearest) continue;
      nearest = way;
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

  /// The face a, b, n is cut between n, outside, and the other two. Its quadrilateral's diagonal
  /// starts at a where true, at b where not, and ends in the other's cut point. Neighbours that
  /// share the face agree, since only the face is asked (the paper's rule: from the end of a cut
  /// long edge; where both cut edges are short, by the parity of the points' coordinates).
  bool diagonal_from_first(int a, int b, int n) const {
    if (lattice_.is_long(a, n)) return false;
    if (lattice_.is_long(b, n)) return true;
    const auto greater = (lattice_.coordinates(a) > lattice_.coordinates(n)).count();
    return greater % 2 == 0;
  }

  void add_inside_of(const std::array<int, 4>& points) {
    std::vector<int>& in = sorted_[2];
    std::vector<int>& on = sorted_[1];
    std::vector<int>& out = sorted_[0];
    for (auto& each : sorted_) each.clear();
    for (const int p : points) sorted_[static_cast<std::size_t>(side(p) + 1)].push_back(p);
    if (in.size() == 1 || out.empty()) {
      add_tetrahedron(in, on, out);
    } else if (in.size() == 2 && out.size() == 1) {
      add_pyramid(in[0], in[1], on[0], out[0]);
    } else if (in.size() == 2) {
      add_wedge(in[0], in[1], out[0], out[1]);
    } else {
      add_truncated(in, out[0]);
    }
  }

  void add_tetrahedron(const std::vector<int>& in, const std::vector<int>& on,
                       const std::vector<int>& out) {
    CornerTetrahedron corners{};
    std::size_t n = 0;
    for (const int p : in) corners[n++] = corner(p);
    for (const int p : on) corners[n++] = corner(p);
    for (const int p : out) corners[n++] = cut(in[0], p);
    tetrahedra_.push_back(corners);
  }

  void add_pyramid(int a, int b, int apex, int n) {
    const int cut_a = cut(a, n), cut_b = cut(b, n);
    const bool from_a = diagonal_from_first(a, b, n);
    tetrahedra_.push_back({corner(apex), corner(a), corner(b), from_a ? cut_b : cut_a});
    tetrahedra_.push_back({corner(apex), cut_a, cut_b, from_a ? corner(a) : corner(b)});
  }

  void add_wedge(int a, int b, int n, int m) {
    // The rules of the two faces that the wedge shares with other tetrahedra give diagonals from
    // different ends of a - b; the third, on the surface, joins their other ends.
    const bool from_a = diagonal_from_first(a, b, n);
    cut_prism({corner(a), cut(a, n), cut(a, m)}, {corner(b), cut(b, n), cut(b, m)},
              {from_a, !from_a, !diagonal_from_first(a, b, m)}, tetrahedra_);
  }

  void add_truncated(const std::vector<int>& in, int n) {
    cut_prism({corner(in[0]), corner(in[1]), corner(in[2])},
              {cut(in[0], n), cut(in[1], n), cut(in[2], n)},
              {diagonal_from_first(in[0], in[1], n), diagonal_from_first(in[1], in[2], n),
               diagonal_from_first(in[2], in[0], n)},
              tetrahedra_);
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
  std::array<std::vector<int>, 3> sorted_;  ///< points of one tetrahedron by side
};

}  // namespace

TetrahedralMesh stuff_negative(const DistanceGrid& grid) { return Stuffing(grid).run(); }

}  // namespace pliant
