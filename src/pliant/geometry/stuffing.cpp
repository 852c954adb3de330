#include "pliant/geometry/stuffing.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "pliant/geometry/distance_grid.h"
#include "pliant/geometry/hole_filling.h"
#include "pliant/geometry/lattice.h"
#include "pliant/geometry/stencils.h"
#include "pliant/math/error.h"

namespace pliant {
namespace {

using Eigen::Vector3d;

// The "safe" alphas of table 1 in the paper: a cut point nearer to a lattice point than that share
// of the edge moves the point onto the surface.
constexpr double kAlphaShort = 0.41189;
constexpr double kAlphaLong = 0.24999;

constexpr double kMaxSamples = 30e6;
constexpr int kMargin = 4;  // samples around the surface

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

double samples_for(const Eigen::AlignedBox3d& bounds, double cell_size) {
  return ((bounds.sizes() / (0.5 * cell_size)).array().ceil() + 1.0 + 2.0 * kMargin).prod();
}

TetrahedralMesh stuff_cells(const TriangleMesh& solid, const Eigen::AlignedBox3d& bounds,
                            double cell_size) {
  DistanceGrid grid;
  grid.spacing = 0.5 * cell_size;
  grid.count = ((bounds.sizes() / grid.spacing).array().ceil() + 1.0 + 2.0 * kMargin).cast<int>();
  grid.origin = bounds.center() - 0.5 * grid.spacing * (grid.count - 1).cast<double>().matrix();
  sample_signed_distance(solid, grid);
  return Stuffing(grid).run();
}

double least_cell_size(const Eigen::AlignedBox3d& bounds) {
  // From below: samples fall as cells grow.
  double low = 0.0, high = bounds.sizes().maxCoeff();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (samples_for(bounds, middle) > kMaxSamples ? low : high) = middle;
  }
  return high;
}

double checked_cell_size(const Eigen::AlignedBox3d& bounds, double cell_size,
                         const std::string& where) {
  const double longest = bounds.sizes().maxCoeff(), least = least_cell_size(bounds);
  if (cell_size >= least && cell_size <= longest) return cell_size;
  throw InputError(fmt::format(
      "{}: cell_size is {:g} m: allowed is [{:.3g}, {:.3g}] (finer asks for more than {:.3g} "
      "distance samples), or 0 to give a number of tetrahedra",
      where, cell_size, least, longest, kMaxSamples));
}

/// Cells that make about as many tetrahedra: their number falls with the cube of the size, up to
/// what the surface adds.
TetrahedralMesh stuff_count(const TriangleMesh& solid, const Eigen::AlignedBox3d& bounds,
                            int target, const std::string& where) {
  const double least = least_cell_size(bounds), longest = bounds.sizes().maxCoeff();
  double low = least, high = longest;  // sizes that make too many, too few
  double size = std::clamp(std::cbrt(12.0 * std::abs(signed_volume(solid)) / target), low, high);
  TetrahedralMesh best;
  double best_error = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < 12 && best_error > 0.05; ++attempt) {
    TetrahedralMesh mesh = stuff_cells(solid, bounds, size);
    const double count = static_cast<double>(mesh.tetrahedra.cols());
    const double error = std::abs(std::log(std::max(count, 0.1) / target));
    if (count > 0.0 && error < best_error) {
      best_error = error;
      best = std::move(mesh);
    }
    (count > target ? low : high) = size;
    size *= std::cbrt(std::max(count, 0.1) / target);
    if (!(size > low && size < high)) size = std::sqrt(low * high);
  }
  if (best_error > 0.05 && high <= 1.01 * least) {
    throw InputError(fmt::format(
        "{}: {} tetrahedra ask for cells below {:.3g} m and more than {:.3g} distance samples: "
        "choose fewer",
        where, target, least, kMaxSamples));
  }
  return best;
}

/// The surface with its small holes closed.
TriangleMesh closed_surface(const TriangleMesh& surface, double hole_size,
                            const std::string& where) {
  const std::vector<Hole> holes = find_holes(surface);
  const auto widest = std::max_element(
      holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.width < b.width; });
  if (widest != holes.end() && widest->width > hole_size) {
    throw InputError(fmt::format(
        "{}: the surface is open: of {} holes the widest, at vertex {}, has {} edges "
        "and is {:.3g} m wide; holes up to {:.3g} m (hole_size) are closed",
        where, holes.size(), widest->rim.front(), widest->rim.size(), widest->width, hole_size));
  }
  TriangleMesh solid = surface;
  fill_holes(solid, holes);
  return solid;
}

void check_options(const StuffingOptions& options, const std::string& where) {
  if (!std::isfinite(options.cell_size) || options.cell_size < 0.0) {
    throw InputError(
        fmt::format("{}: cell_size is {} m: allowed is > 0, or 0 to give a number of tetrahedra",
                    where, options.cell_size));
  }
  if (options.tetrahedra < 1 || options.tetrahedra > kMaxTetrahedra) {
    throw InputError(fmt::format("{}: tetrahedra is {}: allowed is [1, {}]", where,
                                 options.tetrahedra, kMaxTetrahedra));
  }
  if (std::isnan(options.hole_size)) {
    throw InputError(fmt::format("{}: hole_size is nan: allowed is any length [m]", where));
  }
}

}  // namespace

TetrahedralMesh stuff(const TriangleMesh& surface, const StuffingOptions& options,
                      const std::string& where) {
  validate(surface, where);
  check_options(options, where);
  const Eigen::AlignedBox3d bounds(surface.vertices.rowwise().minCoeff(),
                                   surface.vertices.rowwise().maxCoeff());
  const bool by_size = options.cell_size > 0.0;
  if (by_size) checked_cell_size(bounds, options.cell_size, where);
  // A surface with holes has no volume yet, its box has.
  const double guess =
      by_size ? options.cell_size : std::cbrt(12.0 * bounds.volume() / options.tetrahedra);
  const TriangleMesh solid =
      closed_surface(surface, options.hole_size < 0.0 ? guess : options.hole_size, where);
  const double volume = signed_volume(solid);
  if (volume < 0.0) {
    throw InputError(
        fmt::format("{}: the surface is inside out, it encloses {:.3g} m^3: reverse its triangles",
                    where, volume));
  }
  TetrahedralMesh mesh = by_size ? stuff_cells(solid, bounds, options.cell_size)
                                 : stuff_count(solid, bounds, options.tetrahedra, where);
  if (mesh.tetrahedra.cols() > 0) return mesh;
  throw InputError(fmt::format(
      "{}: there is no interior: the solid ({:.3g} m^3 in a box of {:.3g} x {:.3g} x {:.3g} m) is "
      "too thin for its cells{}: choose a smaller cell_size",
      where, volume, bounds.sizes()[0], bounds.sizes()[1], bounds.sizes()[2],
      by_size ? fmt::format(" of {:g} m", options.cell_size) : ""));
}

}  // namespace pliant
