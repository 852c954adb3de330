#include "pliant/geometry/search/mesh_distances.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "pliant/math/widest.h"

// Only a function that is part of another one is compiled for the registers that one is for.
#define PLIANT_INLINE inline __attribute__((always_inline))

namespace pliant {
namespace {

using Face = MeshDistances::Face;
using Node = MeshDistances::Node;
// A number of each point.
using Lanes = double __attribute__((vector_size(8 * MeshDistances::kLanes)));
using Mask = decltype(Lanes() < Lanes());
// Nodes of a tree of 2³¹ triangles that wait to be looked at: it is halved at each.
constexpr int kMostWaiting = 64;

struct Waiting {
  int inside;
  Lanes least;  // squared distances of its box
};

PLIANT_INLINE bool any(const Mask& mask) {
  long long sum = 0;
  for (int l = 0; l < MeshDistances::kLanes; ++l) sum |= mask[l];
  return sum != 0;
}

PLIANT_INLINE double sum_of(const Lanes& a) {
  return ((a[0] + a[1]) + (a[2] + a[3])) + ((a[4] + a[5]) + (a[6] + a[7]));
}

/// Squared distances from a box.
PLIANT_INLINE void from_box(const Lanes* p, const double* low, const double* high, Lanes& squared) {
  const Lanes none = {};
  squared = none;
  for (int d = 0; d < 3; ++d) {
    const Lanes below = low[d] - p[d], above = p[d] - high[d];
    Lanes beyond = below > above ? below : above;
    beyond = beyond > none ? beyond : none;
    squared += beyond * beyond;
  }
}

/// Which points are in the prism over a face, and squared distances from its plane.
PLIANT_INLINE void from_plane(const Lanes (*from)[3], const Lanes* p, const Face& face,
                              Mask& is_over, Lanes& squared) {
  const Lanes none = {};
  const double* n = face.normal;
  is_over = ~Mask{};
  for (int c = 0; c < 3; ++c) {
    const double* s = face.sides[c];
    const Lanes* f = from[c];
    const Lanes side = (s[1] * f[2] - s[2] * f[1]) * n[0] + (s[2] * f[0] - s[0] * f[2]) * n[1] +
                       (s[0] * f[1] - s[1] * f[0]) * n[2];
    is_over &= side >= none;
  }
  squared = none;
  if (!any(is_over)) return;
  const Lanes share = (n[0] * from[0][0] + n[1] * from[0][1] + n[2] * from[0][2]) / face.area;
  for (int d = 0; d < 3; ++d) {
    const Lanes between = (p[d] - share * n[d]) - p[d];
    squared += between * between;
  }
}

/// Squared distances from the nearest of a face's sides.
PLIANT_INLINE void from_sides(const Lanes (*from)[3], const Lanes* p, const Face& face,
                              Lanes& squared) {
  const Lanes none = {}, all = none + 1.0;
  squared = none + HUGE_VAL;
  for (int c = 0; c < 3; ++c) {
    const double* s = face.sides[c];
    const Lanes* f = from[c];
    Lanes share = none;
    if (face.lengths[c] != 0.0) {
      share = (s[0] * f[0] + s[1] * f[1] + s[2] * f[2]) / face.lengths[c];
      share = share < none ? none : share;
      share = share > all ? all : share;
    }
    Lanes each = none;
    for (int d = 0; d < 3; ++d) {
      const Lanes between = (face.corners[c][d] + share * s[d]) - p[d];
      each += between * between;
    }
    squared = each < squared ? each : squared;
  }
}

/// Squared distances from a face: the numbers of closest_on_triangle(), point by point.
PLIANT_INLINE void from_face(const Lanes* p, const Face& face, Lanes& squared) {
  Lanes from[3][3];  // corners
  for (int c = 0; c < 3; ++c) {
    for (int d = 0; d < 3; ++d) from[c][d] = p[d] - face.corners[c][d];
  }
  if (!(face.area > 0.0)) {
    from_sides(from, p, face, squared);
    return;
  }
  Mask is_over;
  from_plane(from, p, face, is_over, squared);
  if (!any(~is_over)) return;
  Lanes beside;
  from_sides(from, p, face, beside);
  squared = is_over ? squared : beside;
}

PLIANT_WIDEST void lower_squared(const Node* nodes, const Face* faces, const double* points,
                                 double* squared_distances, int* hint) {
  Lanes p[3], best;
  std::memcpy(p, points, sizeof p);
  std::memcpy(&best, squared_distances, sizeof best);
  if (*hint >= 0) {
    Lanes each;
    from_face(p, faces[*hint], each);
    best = each < best ? each : best;
  }
  Waiting waiting[kMostWaiting];
  waiting[0] = {0, Lanes{}};
  for (int count = 1; count > 0;) {
    const Waiting next = waiting[--count];
    if (!any(next.least < best)) continue;
    if (next.inside < 0) {
      Lanes each;
      from_face(p, faces[~next.inside], each);
      const Mask nearer = each < best;
      if (!any(nearer)) continue;
      *hint = ~next.inside;
      best = nearer ? each : best;
      continue;
    }
    const Node& node = nodes[next.inside];
    Lanes least[2];
    for (int k = 0; k < 2; ++k) from_box(p, node.low[k], node.high[k], least[k]);
    // The nearer one is looked at first, and so lies on top.
    const int first = sum_of(least[1] - least[0]) < 0.0 ? 1 : 0;
    for (const int k : {1 - first, first}) {
      if (node.inside[k] == MeshDistances::kNothing || !any(least[k] < best)) continue;
      waiting[count++] = {node.inside[k], least[k]};
    }
  }
  std::memcpy(squared_distances, &best, sizeof best);
}

Face make_face(const TriangleMesh& mesh, Eigen::Index t) {
  Eigen::Matrix3d corners;
  for (int c = 0; c < 3; ++c) corners.col(c) = mesh.vertices.col(mesh.triangles(c, t));
  Face face;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Vector3d side = corners.col((c + 1) % 3) - corners.col(c);
    Eigen::Map<Eigen::Vector3d>(face.corners[c]) = corners.col(c);
    Eigen::Map<Eigen::Vector3d>(face.sides[c]) = side;
    face.lengths[c] = side.squaredNorm();
  }
  const Eigen::Vector3d normal =
      (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  Eigen::Map<Eigen::Vector3d>(face.normal) = normal;
  face.area = normal.squaredNorm();
  return face;
}

}  // namespace

MeshDistances::MeshDistances(const TriangleMesh& mesh) {
  std::vector<std::array<double, 6>> boxes;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    faces_.push_back(make_face(mesh, t));
    std::array<double, 6> box;
    for (int d = 0; d < 3; ++d) {
      const double a = faces_.back().corners[0][d], b = faces_.back().corners[1][d],
                   c = faces_.back().corners[2][d];
      box[d] = std::min({a, b, c});
      box[d + 3] = std::max({a, b, c});
    }
    boxes.push_back(box);
  }
  if (faces_.empty()) return;
  std::vector<int> order(faces_.size());
  std::iota(order.begin(), order.end(), 0);
  nodes_.reserve(order.size());
  add_node(boxes, order.data(), order.data() + order.size());
}

int MeshDistances::add_node(const std::vector<std::array<double, 6>>& boxes, int* begin, int* end) {
  const int number = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  const auto middle_of = [&](int face, int d) {
    const auto& box = boxes[static_cast<std::size_t>(face)];
    return box[static_cast<std::size_t>(d)] + box[static_cast<std::size_t>(d) + 3];
  };
  // Halved across the longest side of the middles' box.
  int longest = 0;
  double length = -1.0;
  for (int d = 0; d < 3; ++d) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const int* face = begin; face != end; ++face) {
      low = std::min(low, middle_of(*face, d));
      high = std::max(high, middle_of(*face, d));
    }
    if (high - low > length) {
      length = high - low;
      longest = d;
    }
  }
  int* const half = begin + (end - begin) / 2;
  std::nth_element(begin, half, end, [&](int a, int b) {
    const double at_a = middle_of(a, longest), at_b = middle_of(b, longest);
    return at_a < at_b || (at_a == at_b && a < b);
  });
  int* const ends[3] = {begin, half, end};
  for (int k = 0; k < 2; ++k) {
    Node node = nodes_[static_cast<std::size_t>(number)];
    for (int d = 0; d < 3; ++d) {
      node.low[k][d] = HUGE_VAL;
      node.high[k][d] = -HUGE_VAL;
      for (const int* face = ends[k]; face != ends[k + 1]; ++face) {
        const auto& box = boxes[static_cast<std::size_t>(*face)];
        node.low[k][d] = std::min(node.low[k][d], box[static_cast<std::size_t>(d)]);
        node.high[k][d] = std::max(node.high[k][d], box[static_cast<std::size_t>(d) + 3]);
      }
    }
    const std::ptrdiff_t count = ends[k + 1] - ends[k];
    node.inside[k] = kNothing;
    if (count == 1) node.inside[k] = ~*ends[k];
    nodes_[static_cast<std::size_t>(number)] = node;
    if (count > 1) {
      const int inside = add_node(boxes, ends[k], ends[k + 1]);
      nodes_[static_cast<std::size_t>(number)].inside[k] = inside;
    }
  }
  return number;
}

void MeshDistances::lower(const Points& points, Lanes& distances, int& hint) const {
  if (faces_.empty()) return;
  alignas(64) double at[3 * kLanes];
  alignas(64) double squared[kLanes];
  std::copy(points.x.begin(), points.x.end(), at);
  std::copy(points.y.begin(), points.y.end(), at + kLanes);
  std::copy(points.z.begin(), points.z.end(), at + 2 * kLanes);
  for (int l = 0; l < kLanes; ++l) {
    squared[l] = distances[static_cast<std::size_t>(l)] * distances[static_cast<std::size_t>(l)];
  }
  lower_squared(nodes_.data(), faces_.data(), at, squared, &hint);
  for (int l = 0; l < kLanes; ++l) {
    distances[static_cast<std::size_t>(l)] = std::sqrt(squared[l]);
  }
}

}  // namespace pliant
