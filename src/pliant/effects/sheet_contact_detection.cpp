#include "pliant/effects/sheet_contact_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pliant/core/parallel.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {
namespace {

// What is joined by an edge touches below this share of its distance at rest.
constexpr double kNearShare = 0.5;
// The thickness is at most this share of the mean edge.
constexpr double kEdgeShare = 0.5;
// Of the mean edge: candidates are this much further apart than what touches.
constexpr double kSlackShare = 0.5;
// Of that distance: what moves faster in a step is collected anew each time.
constexpr double kSlowShare = 0.25;
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
  full_slack_ = kSlackShare * length / count;
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
  const double half = 0.5 * (thickness_ + margin_ + slack_);
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

void SheetContactDetection::follow(const Particles& particles) {
  const bool is_first = collected_start_.cols() != particles.x.cols();
  const Eigen::Vector3d way =
      is_first ? Eigen::Vector3d::Zero() : (particles.x_start - start_).rowwise().mean().eval();
  path_ += ((particles.x_start - start_).colwise() - way).colwise().norm().maxCoeff();
  // The frame of the candidates moves with the sheet.
  collected_start_.colwise() += way;
  collected_end_.colwise() += way;
  start_ = particles.x_start;
  end_ = particles.x;
  end_.colwise() -= (end_ - start_).rowwise().mean().eval();
  motion_ = (end_ - start_).colwise().norm().maxCoeff();
}

bool SheetContactDetection::are_candidates_good() const {
  if (collected_start_.cols() != start_.cols()) return false;
  const double squared = 0.25 * slack_ * slack_;
  const auto is_near = [&](const Eigen::Vector3d& x, Eigen::Index i) {
    return (x - collected_end_.col(i)).squaredNorm() <= squared ||
           (x - collected_start_.col(i)).squaredNorm() <= squared;
  };
  for (Eigen::Index i = 0; i < start_.cols(); ++i) {
    if (!is_near(end_.col(i), i) || !is_near(start_.col(i), i)) return false;
  }
  return true;
}

void SheetContactDetection::find(const Particles& particles, double dt,
                                 std::vector<PairContact>& contacts) {
  follow(particles);
  if (!are_candidates_good()) collect();
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) look(blocks_[static_cast<std::size_t>(b)]);
  });
  contacts.clear();
  for (const Block& block : blocks_) {
    for (const Found& found : block.found) contacts.push_back(contact(found, dt));
  }
}

void SheetContactDetection::collect() {
  // Where vertices go further in a step than the slack is wide, it buys nothing.
  slack_ = motion_ < kSlowShare * full_slack_ ? full_slack_ : 0.0;
  collected_start_ = start_;
  collected_end_ = end_;
  enclose(triangles_, triangle_boxes_);
  enclose(edges_, edge_boxes_);
  triangle_tree_.refit(triangle_boxes_);
  edge_tree_.refit(edge_boxes_);
  const int vertices = static_cast<int>(rest_.cols()), edges = static_cast<int>(edges_.cols());
  blocks_.resize(static_cast<std::size_t>((vertices + edges + kBlock - 1) / kBlock));
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      std::vector<Candidate>& candidates = blocks_[static_cast<std::size_t>(b)].candidates;
      candidates.clear();
      blocks_[static_cast<std::size_t>(b)].wake = 0.0;
      for (int k = b * kBlock; k < std::min(vertices + edges, (b + 1) * kBlock); ++k) {
        k < vertices ? collect_around_vertex(k, candidates)
                     : collect_around_edge(k - vertices, candidates);
      }
    }
  });
}

void SheetContactDetection::collect_around_vertex(int v, std::vector<Candidate>& candidates) const {
  const double half = 0.5 * (thickness_ + margin_ + slack_);
  Box box(start_.col(v));
  box.extend(end_.col(v));
  box.min().array() -= half;
  box.max().array() += half;
  triangle_tree_.for_each_meeting(box, [&](int t) {
    const auto corners = triangles_.col(t);
    if ((corners.array() == v).any()) return;
    candidates.push_back(
        candidate(SimplexPair::kPointTriangle, {v, corners[0], corners[1], corners[2]}));
  });
}

void SheetContactDetection::collect_around_edge(int e, std::vector<Candidate>& candidates) const {
  const auto own = edges_.col(e);
  edge_tree_.for_each_meeting(edge_boxes_[static_cast<std::size_t>(e)], [&](int other) {
    if (other <= e) return;
    const auto edge = edges_.col(other);
    if ((edge.array() == own[0]).any() || (edge.array() == own[1]).any()) return;
    candidates.push_back(candidate(SimplexPair::kSegments, {own[0], own[1], edge[0], edge[1]}));
  });
}

SheetContactDetection::Candidate SheetContactDetection::candidate(SimplexPair kind,
                                                                  const Four& particles) const {
  Candidate candidate{kind, particles, thickness_, 0.0};
  if (are_joined(kind, particles)) {
    const FourPoints rest = corners_of(rest_, particles);
    const double apart = (rest * nearest_pair(kind, rest)).norm();
    candidate.thickness = std::min(thickness_, kNearShare * apart);
  }
  return candidate;
}

void SheetContactDetection::look(Block& block) const {
  block.found.clear();
  if (path_ + motion_ < block.wake) return;
  block.wake = std::numeric_limits<double>::infinity();
  int vertex = -1;
  std::size_t first = 0;
  for (Candidate& candidate : block.candidates) {
    if (!(candidate.thickness > 0.0)) continue;
    if (path_ + motion_ < candidate.wake) {
      block.wake = std::min(block.wake, candidate.wake);
      continue;
    }
    const bool is_vertex = candidate.kind == SimplexPair::kPointTriangle;
    if (is_vertex && candidate.particles[0] != vertex) {
      keep_first(first, block.found);
      first = block.found.size();
      vertex = candidate.particles[0];
    } else if (!is_vertex && vertex >= 0) {
      keep_first(first, block.found);
      vertex = -1;
    }
    const double reach = candidate.thickness + margin_;
    Approach approach;
    const bool is_near = find_approach(candidate.kind, corners_of(start_, candidate.particles),
                                       corners_of(end_, candidate.particles), reach, approach);
    // Both of its simplices may come as far as any vertex does.
    candidate.wake = path_ + 0.5 * (approach.start - reach);
    block.wake = std::min(block.wake, candidate.wake);
    if (!is_near) continue;
    // At the ends of segments their vertices have contacts of their own.
    if (!is_vertex && !(approach.weights.cwiseAbs().minCoeff() > kWithin)) continue;
    block.found.push_back({candidate.kind, candidate.particles, candidate.thickness, approach});
  }
  if (vertex >= 0) keep_first(first, block.found);
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
