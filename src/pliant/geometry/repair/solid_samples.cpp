#include "pliant/geometry/repair/solid_samples.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "pliant/geometry/distance/sample_rows.h"
#include "pliant/geometry/mesh/mesh_faults.h"
#include "pliant/geometry/repair/generalized_winding.h"
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
  const NearestTriangle nearest(mesh);
  for_each_sample(grid, [&] {
    return [&, hint = -1](std::size_t index, const Vector3d& p) mutable {
      distances[index] = nearest.distance(p, distances[index], hint);
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
    find_winding();
    fill_cavities();
    bool is_whole = true;
    const TriangleMesh boundary = find_boundary(is_whole);
    if (!is_whole) distance_ = distances_to(boundary, grid_, farthest_);
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
    distance_ = distances_to(mesh_, grid_, farthest_);
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

  /// What no way from the grid's corner leads to is inside.
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

  bool is_inside(const Vector3d& p) const {
    if (winding_(p) > kInside) return true;
    const Array3i at = ((p - grid_.origin) / grid_.spacing).array().round().cast<int>();
    if ((at < 0).any() || (at >= grid_.count).any()) return false;
    return is_cavity_[index(at)] != 0;
  }

  struct PieceSides {
    std::vector<Vector3d> corners;  // of the pieces that are part of the boundary
    double area = 0.0, loose = 0.0;
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
    const auto corner = [&](int i, int j) -> Vector3d {
      return a + (static_cast<double>(i) / cuts) * u + (static_cast<double>(j) / cuts) * v;
    };
    const auto look = [&](const Vector3d& p, const Vector3d& q, const Vector3d& r) {
      const Vector3d middle = (p + q + r) / 3.0;
      const bool front = is_inside(middle + off), behind = is_inside(middle - off);
      sides.area += area;
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
    return sides;
  }

  /// The surface without walls inside and sheets outside; `is_whole`: it has none.
  TriangleMesh find_boundary(bool& is_whole) {
    const int count = static_cast<int>(mesh_.triangles.cols());
    std::vector<PieceSides> sides(static_cast<std::size_t>(count));
    tbb::parallel_for(tbb::blocked_range<int>(0, count, 16),
                      [&](const tbb::blocked_range<int>& part) {
                        for (int t = part.begin(); t < part.end(); ++t) {
                          if (!is_degenerate(mesh_, t)) sides[t] = look_at(t);
                        }
                      });
    std::vector<Vector3d> corners;
    double area = 0.0, loose = 0.0;
    for (const PieceSides& side : sides) {
      corners.insert(corners.end(), side.corners.begin(), side.corners.end());
      area += side.area;
      loose += side.loose;
      is_whole = is_whole && side.is_whole;
    }
    found_.loose = area > 0.0 ? loose / area : 0.0;
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

  const TriangleMesh& mesh_;
  DistanceGrid& grid_;
  const double farthest_;
  GeneralizedWinding winding_;
  std::vector<float> winding_at_;
  std::vector<char> inside_, is_cavity_;
  std::vector<double> distance_;
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
