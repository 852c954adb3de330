#include "pliant/effects/sheet_contact_detection.h"

#include <algorithm>
#include <cmath>

#include "pliant/core/parallel.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {
namespace {

// What is joined by an edge touches below this share of its distance at rest.
constexpr double kNearShare = 0.5;
// The thickness is at most this share of the mean edge.
constexpr double kEdgeShare = 0.5;
// Vertices or edges that a thread takes at once.
constexpr int kBlock = 256;
// Places nearer than this share of the thickness have no direction of their own.
constexpr double kTouching = 1e-6;
// Nearest points that agree to this share of the thickness are one.
constexpr double kSamePlace = 1e-9;
// Segments are nearest within both but for this share of their lengths; at their ends the vertices
// have contacts of their own.
constexpr double kWithin = 1e-9;

FourPoints corners_of(const Positions& x, const Eigen::Vector4i& particles) {
  FourPoints corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = x.col(particles[k]);
  return corners;
}

}  // namespace

SheetContactDetection::SheetContactDetection(const Positions& rest,
                                             const Eigen::Matrix3Xi& triangles,
                                             const Options& options)
    : rest_(rest),
      triangles_(triangles),
      thickness_(options.thickness),
      margin_(options.margin),
      friction_(options.friction) {
  take_edges(triangles);
  double length = 0.0;
  for (const auto edge : edges_.colwise()) length += (rest.col(edge[0]) - rest.col(edge[1])).norm();
  const auto count = static_cast<double>(std::max<Eigen::Index>(1, edges_.cols()));
  thickness_ = std::min(thickness_, kEdgeShare * length / count);
  start_ = end_ = rest;
  enclose(triangles_, triangle_boxes_);
  enclose(edges_, edge_boxes_);
  triangle_tree_.build(triangle_boxes_);
  edge_tree_.build(edge_boxes_);
}

void SheetContactDetection::take_edges(const Eigen::Matrix3Xi& triangles) {
  const Edges edges = pliant::edges({rest_, triangles});
  edges_.resize(2, static_cast<Eigen::Index>(edges.vertices.size()));
  neighbors_.resize(static_cast<std::size_t>(rest_.cols()));
  for (std::size_t e = 0; e < edges.vertices.size(); ++e) {
    const auto [a, b] = edges.vertices[e];
    edges_.col(static_cast<Eigen::Index>(e)) << a, b;
    neighbors_[static_cast<std::size_t>(a)].push_back(b);
    neighbors_[static_cast<std::size_t>(b)].push_back(a);
  }
  for (std::vector<int>& neighbors : neighbors_) std::sort(neighbors.begin(), neighbors.end());
}

template <int kCorners>
void SheetContactDetection::enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
                                    std::vector<Box>& boxes) const {
  const double half = 0.5 * (thickness_ + margin_);
  boxes.resize(static_cast<std::size_t>(simplices.cols()));
  for (Eigen::Index s = 0; s < simplices.cols(); ++s) {
    Box box;
    for (int k = 0; k < kCorners; ++k) {
      box.extend(start_.col(simplices(k, s)));
      box.extend(end_.col(simplices(k, s)));
    }
    box.min().array() -= half;
    box.max().array() += half;
    boxes[static_cast<std::size_t>(s)] = box;
  }
}

void SheetContactDetection::find(const Particles& particles, double dt,
                                 std::vector<PairContact>& contacts) {
  start_ = particles.x_start;
  end_ = particles.x;
  end_.colwise() -= (end_ - start_).rowwise().mean().eval();
  enclose(triangles_, triangle_boxes_);
  enclose(edges_, edge_boxes_);
  triangle_tree_.refit(triangle_boxes_);
  edge_tree_.refit(edge_boxes_);
  const int vertices = static_cast<int>(rest_.cols()), edges = static_cast<int>(edges_.cols());
  blocks_.resize(static_cast<std::size_t>((vertices + edges + kBlock - 1) / kBlock));
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      std::vector<Found>& found = blocks_[static_cast<std::size_t>(b)];
      found.clear();
      for (int k = b * kBlock; k < std::min(vertices + edges, (b + 1) * kBlock); ++k) {
        k < vertices ? look_around_vertex(k, found) : look_around_edge(k - vertices, found);
      }
    }
  });
  contacts.clear();
  for (const std::vector<Found>& block : blocks_) {
    for (const Found& found : block) contacts.push_back(contact(found, dt));
  }
}

void SheetContactDetection::look_around_vertex(int v, std::vector<Found>& found) const {
  const double half = 0.5 * (thickness_ + margin_);
  Box box(start_.col(v));
  box.extend(end_.col(v));
  box.min().array() -= half;
  box.max().array() += half;
  const std::size_t first = found.size();
  triangle_tree_.for_each_meeting(box, [&](int t) {
    const auto corners = triangles_.col(t);
    if ((corners.array() == v).any()) return;
    look(SimplexPair::kPointTriangle, {v, corners[0], corners[1], corners[2]}, found);
  });
  keep_first(first, found);
}

void SheetContactDetection::keep_first(std::size_t first, std::vector<Found>& found) {
  std::size_t kept = first;
  for (std::size_t k = first; k < found.size(); ++k) {
    const Eigen::Vector3d& way = found[k].approach.way;
    const bool is_new =
        std::none_of(found.begin() + static_cast<std::ptrdiff_t>(first),
                     found.begin() + static_cast<std::ptrdiff_t>(kept), [&](const Found& other) {
                       return (other.approach.way - way).norm() <= kSamePlace * found[k].thickness;
                     });
    if (is_new) found[kept++] = found[k];
  }
  found.resize(kept);
}

void SheetContactDetection::look_around_edge(int e, std::vector<Found>& found) const {
  const auto own = edges_.col(e);
  edge_tree_.for_each_meeting(edge_boxes_[static_cast<std::size_t>(e)], [&](int other) {
    if (other <= e) return;
    const auto edge = edges_.col(other);
    if ((edge.array() == own[0]).any() || (edge.array() == own[1]).any()) return;
    look(SimplexPair::kSegments, {own[0], own[1], edge[0], edge[1]}, found);
  });
}

void SheetContactDetection::look(SimplexPair kind, const Four& particles,
                                 std::vector<Found>& found) const {
  Found pair{kind, particles, thickness_, {}};
  if (are_joined(kind, particles)) {
    const FourPoints rest = corners_of(rest_, particles);
    pair.thickness = std::min(thickness_, kNearShare * (rest * nearest_pair(kind, rest)).norm());
  }
  const FourPoints start = corners_of(start_, particles);
  if (!(pair.thickness > 0.0) || !find_approach(kind, start, corners_of(end_, particles),
                                                pair.thickness + margin_, pair.approach)) {
    return;
  }
  const Eigen::Vector4d& weights = pair.approach.weights;
  const bool is_within = weights.cwiseAbs().minCoeff() > kWithin;
  if (kind == SimplexPair::kSegments && !is_within) return;
  found.push_back(pair);
}

bool SheetContactDetection::are_joined(SimplexPair kind, const Four& particles) const {
  const int first = kind == SimplexPair::kSegments ? 2 : 1;
  for (int a = 0; a < first; ++a) {
    for (int b = first; b < 4; ++b) {
      if (share_an_edge(particles[a], particles[b])) return true;
    }
  }
  return false;
}

bool SheetContactDetection::share_an_edge(int a, int b) const {
  const std::vector<int>& neighbors = neighbors_[static_cast<std::size_t>(a)];
  return std::binary_search(neighbors.begin(), neighbors.end(), b);
}

Eigen::Vector3d SheetContactDetection::normal_of(int vertex) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto t : triangles_.colwise()) {
    if (!(t.array() == vertex).any()) continue;
    const Eigen::Vector3d a = start_.col(t[1]) - start_.col(t[0]);
    sum += a.cross(start_.col(t[2]) - start_.col(t[0]));
  }
  return sum;
}

Eigen::Vector3d SheetContactDetection::way_out(const Found& found) const {
  const FourPoints at = corners_of(start_, found.particles);
  if (found.kind == SimplexPair::kSegments) {
    const Eigen::Vector3d across = (at.col(1) - at.col(0)).cross(at.col(3) - at.col(2));
    return across.z() < 0.0 ? -across : across;
  }
  const Eigen::Vector3d normal = (at.col(2) - at.col(1)).cross(at.col(3) - at.col(1));
  // Layers that face each other, as those of a fold do, both leave to the side that they turn to
  // each other; of others the order of their vertices decides, so that both agree.
  const Eigen::Vector3d own = normal_of(found.particles[0]);
  if (own.dot(normal) < 0.0) return normal;
  const bool is_first = found.particles[0] < found.particles.tail<3>().minCoeff();
  return is_first ? Eigen::Vector3d(-normal) : normal;
}

PairContact SheetContactDetection::contact(const Found& found, double dt) const {
  PairContact contact;
  const Eigen::Vector3d& way = found.approach.way;
  const bool has_way = way.norm() > kTouching * found.thickness;
  const Eigen::Vector3d out = has_way ? way : way_out(found);
  contact.normal = out.stableNormalized();
  if (contact.normal.isZero(0.0)) contact.normal = Eigen::Vector3d::UnitZ();
  contact.count = 4;
  for (int k = 0; k < 4; ++k) {
    contact.particles[static_cast<std::size_t>(k)] = found.particles[k];
    contact.weights[static_cast<std::size_t>(k)] = found.approach.weights[k];
  }
  contact.friction = friction_;
  contact.start = contact.relative(start_);
  contact.least = found.thickness;
  if (found.approach.time == 0.0) {
    const double gap = contact.normal.dot(contact.start);
    contact.least = std::min(contact.least, gap + kMaxPushOutSpeed * dt);
  }
  return contact;
}

}  // namespace pliant
