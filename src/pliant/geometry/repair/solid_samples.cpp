#include "pliant/geometry/repair/solid_samples.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "pliant/geometry/distance/sample_blocks.h"
#include "pliant/geometry/distance/sample_rows.h"
#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/repair/generalized_winding.h"
#include "pliant/geometry/search/mesh_distances.h"
#include "pliant/geometry/search/nearest_triangle.h"

namespace pliant {
namespace {

using Eigen::Array3i;
using Eigen::Vector3d;

constexpr double kInside = 0.5;      // winding numbers above are inside
constexpr double kProbe = 0.02;      // how far off a piece its two sides are looked at [spacings]
constexpr double kCrossing = 1.001;  // [spacings]

std::size_t sample_count(const DistanceGrid& grid) {
  return static_cast<std::size_t>(grid.count[0]) * grid.count[1] * grid.count[2];
}

/// Calls visit(index, position) for all samples, a row along x after the other in one thread.
template <class MakeVisit>
void for_each_sample(const DistanceGrid& grid, const MakeVisit& make_visit) {
  for_each_row(grid.count, [&] {
    return [&grid, visit = make_visit()](std::size_t index, const Vector3d& at) mutable {
      visit(index, grid.origin + grid.spacing * at);
    };
  });
}

/// Lowers distances to those to a mesh, where that is nearer.
void lower_distances(std::vector<double>& distances, const TriangleMesh& mesh,
                     const DistanceGrid& grid) {
  if (mesh.triangles.cols() == 0) return;
  const MeshDistances mesh_distances(mesh);
  for_each_block(grid.count, [&] {
    return [&, hint = -1](const auto& indices, MeshDistances::Points at) mutable {
      MeshDistances::Lanes lowered;
      for (std::size_t l = 0; l < indices.size(); ++l) {
        at.x[l] = grid.origin[0] + grid.spacing * at.x[l];
        at.y[l] = grid.origin[1] + grid.spacing * at.y[l];
        at.z[l] = grid.origin[2] + grid.spacing * at.z[l];
        lowered[l] = distances[indices[l]];
      }
      mesh_distances.lower(at, lowered, hint);
      for (std::size_t l = 0; l < indices.size(); ++l) distances[indices[l]] = lowered[l];
    };
  });
}

/// No distance is greater than `farthest`.
std::vector<double> distances_to(const TriangleMesh& mesh, const DistanceGrid& grid,
                                 double farthest) {
  std::vector<double> distances(sample_count(grid), farthest);
  lower_distances(distances, mesh, grid);
  return distances;
}

TriangleMesh triangles_of(const std::vector<Vector3d>& corners) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(corners.size()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(corners.size() / 3));
  for (std::size_t v = 0; v < corners.size(); ++v) mesh.vertices.col(v) = corners[v];
  for (Eigen::Index k = 0; k < mesh.triangles.size(); ++k) {
    mesh.triangles.data()[k] = static_cast<int>(k);
  }
  return mesh;
}

class SolidSampling {
 public:
  SolidSampling(const TriangleMesh& mesh, DistanceGrid& grid, double farthest)
      : mesh_(mesh), grid_(grid), farthest_(farthest), winding_(mesh) {}

  SolidSamples run() {
    constexpr int kMostPasses = 3;
    look();
    for (int pass = 1; pass < kMostPasses && leave_out_sheets(); ++pass) look();
    if (!is_whole_) distance_ = distances_to(boundary_of(sides_), grid_, farthest_);
    found_.loose = area_ > 0.0 ? loose_ / area_ : 0.0;
    close_holes();
    grid_.samples.resize(distance_.size());
    for (std::size_t i = 0; i < distance_.size(); ++i) {
      grid_.samples[i] = static_cast<float>(inside_[i] != 0 ? -distance_[i] : distance_[i]);
      found_.has_inside = found_.has_inside || grid_.samples[i] < 0.0f;
    }
    return found_;
  }

 private:
  static constexpr float kUnknown = 1e30f;  // a winding number that is still to be found

  void find_winding() {
    winding_at_.assign(sample_count(grid_), kUnknown);
    // Also to what was left out since: fewer blocks are clear then, none wrongly.
    if (distance_.empty()) distance_ = distances_to(mesh_, grid_, farthest_);
    for_each_sample(grid_, [&] {
      return [&](std::size_t index, const Vector3d& p) {
        const Array3i at = coordinates(index);
        if ((at - at / 2 * 2 == 0).all()) winding_at_[index] = static_cast<float>(winding_(p));
      };
    });
    copy_where_even();
    for_each_sample(grid_, [&] {
      return [&](std::size_t index, const Vector3d& p) {
        if (winding_at_[index] == kUnknown) winding_at_[index] = static_cast<float>(winding_(p));
      };
    });
    inside_.resize(winding_at_.size());
    for (std::size_t i = 0; i < inside_.size(); ++i) inside_[i] = winding_at_[i] > kInside ? 1 : 0;
  }

  /// Away from triangles the winding number has no extremum: where it is on one side at the corners
  /// of a block of two spacings that no triangle comes near, it is so throughout.
  void copy_where_even() {
    constexpr double kClear = 1.8;  // spacings from the middle of a block to its corners, and more
    constexpr float kSure = 0.1f;
    Array3i at;
    for (at[2] = 0; at[2] + 2 < grid_.count[2]; at[2] += 2) {
      for (at[1] = 0; at[1] + 2 < grid_.count[1]; at[1] += 2) {
        for (at[0] = 0; at[0] + 2 < grid_.count[0]; at[0] += 2) {
          if (distance_[index(at + 1)] <= kClear * grid_.spacing) continue;
          float low = std::numeric_limits<float>::infinity(), high = -low;
          for (int c = 0; c < 8; ++c) {
            const float w = winding_at_[index(at + 2 * Array3i(c & 1, c >> 1 & 1, c >> 2 & 1))];
            low = std::min(low, w);
            high = std::max(high, w);
          }
          const bool is_even = high < kInside - kSure || low > kInside + kSure;
          for (int k = 0; k < 27 && is_even; ++k) {
            float& w = winding_at_[index(at + Array3i(k % 3, k / 3 % 3, k / 9))];
            if (w == kUnknown) w = 0.5f * (low + high);
          }
        }
      }
    }
  }

  std::size_t index(const Array3i& at) const {
    return (static_cast<std::size_t>(at[2]) * grid_.count[1] + at[1]) * grid_.count[0] + at[0];
  }
  Array3i coordinates(std::size_t index) const {
    const std::size_t row = index / grid_.count[0];
    return {static_cast<int>(index % grid_.count[0]), static_cast<int>(row % grid_.count[1]),
            static_cast<int>(row / grid_.count[1])};
  }

  /// Calls visit(neighbour) for the up to six neighbours of a sample.
  template <class Visit>
  void for_each_neighbour(std::size_t index, const Visit& visit) const {
    const std::size_t row = grid_.count[0], layer = row * grid_.count[1];
    const std::size_t x = index % row, y = index / row % grid_.count[1], z = index / layer;
    if (x > 0) visit(index - 1);
    if (x + 1 < row) visit(index + 1);
    if (y > 0) visit(index - row);
    if (y + 1 < static_cast<std::size_t>(grid_.count[1])) visit(index + row);
    if (z > 0) visit(index - layer);
    if (z + 1 < static_cast<std::size_t>(grid_.count[2])) visit(index + layer);
  }

  /// What no path from the grid's corner leads to is inside.
  void fill_cavities() {
    is_cavity_.assign(inside_.size(), 1);
    std::vector<std::size_t> open = {0};
    is_cavity_[0] = 0;
    while (!open.empty()) {
      const std::size_t at = open.back();
      open.pop_back();
      for_each_neighbour(at, [&](std::size_t next) {
        if (is_cavity_[next] == 0 || inside_[next] != 0) return;
        is_cavity_[next] = 0;
        open.push_back(next);
      });
    }
    for (std::size_t i = 0; i < inside_.size(); ++i) {
      if (inside_[i] != 0) is_cavity_[i] = 0;
      if (is_cavity_[i] != 0) inside_[i] = 1;
    }
  }

  bool is_in_cavity(const Vector3d& p) const {
    const Array3i at = ((p - grid_.origin) / grid_.spacing).array().round().cast<int>();
    if ((at < 0).any() || (at >= grid_.count).any()) return false;
    return is_cavity_[index(at)] != 0;
  }

  struct TwoSides {
    bool front, behind;   // whether they are inside
    bool bounds_nothing;  // a single wall or sheet
  };

  /// What is in front of and behind a place on the surface. The winding number changes by one
  /// there: by the boundary of a solid from 1 to 0, by a single sheet outside of it from 1/2 to
  /// -1/2, by a single wall within from 3/2 to 1/2, so that one side of these would be a matter of
  /// rounding. Where the boundaries of two solids meet in a plane, it changes by two.
  TwoSides sides_of(const Vector3d& at, const Vector3d& off) const {
    constexpr double kNearly = 0.2, kOneChange = 1.5;
    const double front = winding_(at + off), behind = winding_(at - off);
    const double mean = 0.5 * (front + behind);
    if (std::abs(behind - front) < kOneChange) {
      if (std::abs(mean) < kNearly) return {false, false, true};
      if (std::abs(mean - 1.0) < kNearly) return {true, true, true};
    }
    return {front > kInside || is_in_cavity(at + off), behind > kInside || is_in_cavity(at - off),
            false};
  }

  struct PieceSides {
    std::vector<Vector3d> corners;  // of the pieces that are part of the boundary
    double area = 0.0, loose = 0.0;
    double sheet = 0.0;    // share of the pieces that bound nothing
    bool is_whole = true;  // all pieces are
  };

  /// Looks at a triangle's two sides, piece by piece about a spacing wide.
  PieceSides look_at(int triangle) const {
    const auto t = mesh_.triangles.col(triangle);
    const Vector3d a = mesh_.vertices.col(t[0]), u = mesh_.vertices.col(t[1]) - a,
                   v = mesh_.vertices.col(t[2]) - a;
    const double longest = std::max({u.norm(), v.norm(), (v - u).norm()});
    const int cuts = std::clamp(static_cast<int>(std::ceil(longest / grid_.spacing)), 1, 256);
    const Vector3d normal = u.cross(v).normalized();
    const Vector3d off = kProbe * grid_.spacing * normal;
    const double area = 0.5 * u.cross(v).norm() / (cuts * cuts);
    PieceSides sides;
    int of_sheet = 0;
    const auto corner = [&](int i, int j) -> Vector3d {
      return a + (static_cast<double>(i) / cuts) * u + (static_cast<double>(j) / cuts) * v;
    };
    const auto look = [&](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
      const auto [front, behind, bounds_nothing] = sides_of((p + q + r) / 3.0, off);
      sides.area += area;
      of_sheet += bounds_nothing ? 1 : 0;
      if (!front && !behind) sides.loose += area;
      if (front == behind) {
        sides.is_whole = false;
      } else {
        sides.corners.insert(sides.corners.end(), {p, q, r});
      }
    };
    for (int i = 0; i < cuts; ++i) {
      for (int j = 0; i + j < cuts; ++j) {
        look(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < cuts) look(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
    }
    if (sides.is_whole) sides.corners = {a, a + u, a + v};
    sides.sheet = static_cast<double>(of_sheet) / (cuts * cuts);
    return sides;
  }

  /// Finds what is inside, and what is on both sides of each triangle.
  void look() {
    find_winding();
    fill_cavities();
    std::vector<int> all(static_cast<std::size_t>(mesh_.triangles.cols()));
    std::iota(all.begin(), all.end(), 0);
    sides_ = sides_of_all(all);
    area_ = left_out_area_;
    loose_ = left_out_loose_;
    is_whole_ = left_out_area_ == 0.0;
    for (const PieceSides& side : sides_) {
      area_ += side.area;
      loose_ += side.loose;
      is_whole_ = is_whole_ && side.is_whole;
    }
  }

  /// Of these triangles; of others, and of those without area, as if there were none.
  std::vector<PieceSides> sides_of_all(const std::vector<int>& triangles) const {
    std::vector<PieceSides> sides(static_cast<std::size_t>(mesh_.triangles.cols()));
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles.size(), 16),
                      [&](const tbb::blocked_range<std::size_t>& part) {
                        for (std::size_t k = part.begin(); k < part.end(); ++k) {
                          const int t = triangles[k];
                          if (!is_degenerate(mesh_, t)) sides[t] = look_at(t);
                        }
                      });
    return sides;
  }

  /// Takes single walls and sheets out of the mesh: near them the winding number is about one half,
  /// as if there were a hole. False where there is nothing else, or less of them than the square
  /// between four samples, which misleads none.
  bool leave_out_sheets() {
    constexpr double kMost = 0.5;  // of a triangle's pieces
    std::vector<int> kept, sheets;
    for (std::size_t t = 0; t < sides_.size(); ++t) {
      (sides_[t].sheet > kMost ? sheets : kept).push_back(static_cast<int>(t));
    }
    double found = 0.0;  // [m²]
    for (const int t : sheets) found += sides_[t].area;
    if (kept.empty() || found < grid_.spacing * grid_.spacing) return false;
    winding_ = GeneralizedWinding(part(kept));
    const std::vector<PieceSides> without = sides_of_all(sheets);
    for (const int t : sheets) {
      if (without[t].sheet <= kMost) {
        kept.push_back(t);  // a part of the boundary beside a wall: there is a hole without it
        continue;
      }
      left_out_area_ += without[t].area;
      left_out_loose_ += without[t].loose;
    }
    std::sort(kept.begin(), kept.end());
    mesh_ = part(kept);
    winding_ = GeneralizedWinding(mesh_);
    return kept.size() < sides_.size();
  }

  TriangleMesh part(const std::vector<int>& triangles) const {
    return {mesh_.vertices, mesh_.triangles(Eigen::all, triangles)};
  }

  /// The surface without walls inside and sheets outside.
  static TriangleMesh boundary_of(const std::vector<PieceSides>& sides) {
    std::vector<Vector3d> corners;
    for (const PieceSides& side : sides) {
      corners.insert(corners.end(), side.corners.begin(), side.corners.end());
    }
    return triangles_of(corners);
  }

  /// Between neighbours on two sides of the surface, none of which is near it, goes what closes a
  /// hole.
  void close_holes() {
    std::vector<Vector3d> corners;
    std::size_t crossings = 0, closing = 0;
    for (std::size_t i = 0; i < inside_.size(); ++i) {
      for_each_neighbour(i, [&](std::size_t j) {
        if (j < i || inside_[i] == inside_[j]) return;
        ++crossings;
        // A triangle between them is as near to both together as they are to each other.
        if (distance_[i] + distance_[j] <= kCrossing * grid_.spacing) return;
        ++closing;
        const double wi = winding_at_[i], wj = winding_at_[j];
        const double share = wi == wj ? 0.5 : std::clamp((kInside - wi) / (wj - wi), 0.0, 1.0);
        corners.insert(corners.end(), 3, position(i) + share * (position(j) - position(i)));
      });
    }
    found_.closed = crossings > 0 ? static_cast<double>(closing) / crossings : 0.0;
    lower_distances(distance_, triangles_of(corners), grid_);
  }

  Vector3d position(std::size_t index) const {
    return grid_.origin + grid_.spacing * coordinates(index).cast<double>().matrix();
  }

  TriangleMesh mesh_;
  DistanceGrid& grid_;
  const double farthest_;
  GeneralizedWinding winding_;
  std::vector<float> winding_at_;
  std::vector<char> inside_, is_cavity_;
  std::vector<double> distance_;
  std::vector<PieceSides> sides_;    // of the triangles
  double area_ = 0.0, loose_ = 0.0;  // of all triangles, and with outside on both sides [m²]
  double left_out_area_ = 0.0, left_out_loose_ = 0.0;  // of those that are no longer in the mesh
  bool is_whole_ = true;                               // each triangle is part of the boundary
  SolidSamples found_;
};

}  // namespace

bool SolidSamples::is_plausible() const {
  constexpr double kMostClosed = 0.25, kMostLoose = 0.1;
  return has_inside && closed <= kMostClosed && loose <= kMostLoose;
}

std::vector<std::string> SolidSamples::phrases() const {
  constexpr double kLeastTold = 0.0005;
  std::vector<std::string> parts;
  if (closed > kLeastTold) {
    parts.push_back(fmt::format("{:.2g} % of the solid's surface closes holes", 100.0 * closed));
  }
  if (loose > kLeastTold) {
    parts.push_back(fmt::format("{:.2g} % of the mesh bounds nothing", 100.0 * loose));
  }
  return parts;
}

SolidSamples sample_solid(const TriangleMesh& mesh, DistanceGrid& grid, double farthest) {
  return SolidSampling(mesh, grid, farthest).run();
}

void sample_shell(const TriangleMesh& mesh, double thickness, DistanceGrid& grid) {
  grid.samples.assign(sample_count(grid), static_cast<float>(kFarthestSample));
  if (mesh.triangles.cols() == 0) return;
  const NearestTriangle nearest(mesh);
  for_each_sample(grid, [&] {
    return [&, hint = -1](std::size_t index, const Vector3d& p) mutable {
      const NearestTriangle::Result found = nearest.near(p, hint);
      grid.samples[index] = static_cast<float>(found.distance - 0.5 * thickness);
      hint = found.triangle;
    };
  });
}

}  // namespace pliant
