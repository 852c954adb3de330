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
// How far a vertex may go before candidates are collected anew: so many times its way in this step,
// within these shares of the mean edge.
constexpr double kStepsAhead = 8.0, kLeastSlack = 0.1, kMostSlack = 0.6;
// Vertices or edges that a thread takes at once.
constexpr int kBlock = 256;
// Places nearer than this share of the thickness have no direction of their own.
constexpr double kTouching = 1e-6;
// Nearest points that agree to this share of the thickness are one.
constexpr double kSamePlace = 1e-9;
// Segments are nearest within both but for this share of their lengths; at their ends the vertices
// have contacts of their own.
constexpr double kWithin = 1e-9;
// Length of a direction in single precision: surely not above 1.
constexpr double kUnit = 1.0 - 1e-6;

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
  mean_edge_ = length / count;
  slacks_.setZero(rest.cols());
  start_ = end_ = rest;
  enclose(triangles_, triangle_boxes_);
  enclose(edges_, edge_boxes_);
  triangle_tree_.build(triangle_boxes_);
  edge_tree_.build(edge_boxes_);
}

void SheetContactDetection::moisten(const WetContact* wet) {
  wet_ = wet;
  margin_ = std::max(margin_, wet->range);
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
  label_pieces();
}

void SheetContactDetection::label_pieces() {
  pieces_.assign(neighbors_.size(), -1);
  std::vector<int> open;
  for (std::size_t seed = 0; seed < pieces_.size(); ++seed) {
    if (pieces_[seed] >= 0) continue;
    pieces_[seed] = static_cast<int>(seed);
    open.assign(1, static_cast<int>(seed));
    while (!open.empty()) {
      const auto i = static_cast<std::size_t>(open.back());
      open.pop_back();
      for (const int other : neighbors_[i]) {
        int& piece = pieces_[static_cast<std::size_t>(other)];
        if (piece >= 0) continue;
        piece = static_cast<int>(seed);
        open.push_back(other);
      }
    }
  }
}

SheetContactDetection::Box SheetContactDetection::box_of(int vertex) const {
  Box box(start_.col(vertex));
  box.extend(end_.col(vertex));
  const double half = 0.5 * (thickness_ + margin_) + slacks_[vertex];
  box.min().array() -= half;
  box.max().array() += half;
  return box;
}

template <int kCorners>
void SheetContactDetection::enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
                                    std::vector<Box>& boxes) const {
  boxes.resize(static_cast<std::size_t>(simplices.cols()));
  for (Eigen::Index s = 0; s < simplices.cols(); ++s) {
    Box box;
    for (int k = 0; k < kCorners; ++k) box.extend(box_of(simplices(k, s)));
    boxes[static_cast<std::size_t>(s)] = box;
  }
}

void SheetContactDetection::follow(const Positions& start, const Positions& end) {
  const bool is_first = collected_start_.cols() != end.cols();
  const Eigen::Vector3d way =
      is_first ? Eigen::Vector3d::Zero() : (start - start_).rowwise().mean().eval();
  path_ += ((start - start_).colwise() - way).colwise().norm().maxCoeff();
  // The frame of the candidates moves with the sheet.
  collected_start_.colwise() += way;
  collected_end_.colwise() += way;
  start_ = start;
  end_ = end;
  mean_motion_ = (end_ - start_).rowwise().mean();
  end_.colwise() -= mean_motion_;
  motion_ = (end_ - start_).colwise().norm().maxCoeff();
}

bool SheetContactDetection::are_candidates_good() const {
  if (collected_start_.cols() != start_.cols()) return false;
  const auto is_near = [&](const Eigen::Vector3d& x, Eigen::Index i) {
    const double squared = slacks_[i] * slacks_[i];
    if ((x - collected_end_.col(i)).squaredNorm() <= squared) return true;
    // Boxes enclose the whole way, so that a part of it is known too.
    const Eigen::Vector3d way = collected_end_.col(i) - collected_start_.col(i);
    const Eigen::Vector3d from = x - collected_start_.col(i);
    const double length = way.squaredNorm();
    const double part = length > 0.0 ? std::clamp(from.dot(way) / length, 0.0, 1.0) : 0.0;
    return (from - part * way).squaredNorm() <= squared;
  };
  for (Eigen::Index i = 0; i < start_.cols(); ++i) {
    if (!is_near(end_.col(i), i) || !is_near(start_.col(i), i)) return false;
  }
  return true;
}

void SheetContactDetection::find(const Particles& particles, double dt,
                                 std::vector<PairContact>& contacts) {
  search(particles.x_start, particles.x);
  make_contacts(dt, contacts);
}

void SheetContactDetection::search(const Positions& start, const Positions& end) {
  follow(start, end);
  if (!are_candidates_good()) collect();
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) look(blocks_[static_cast<std::size_t>(b)]);
  });
}

void SheetContactDetection::make_contacts(double dt, std::vector<PairContact>& contacts) const {
  contacts.clear();
  for (const Block& block : blocks_) {
    for (const Found& found : block.found) contacts.push_back(contact(found, dt));
  }
}

void SheetContactDetection::collect() {
  slacks_ = (kStepsAhead * (end_ - start_).colwise().norm())
                .cwiseMax(kLeastSlack * mean_edge_)
                .cwiseMin(kMostSlack * mean_edge_)
                .transpose();
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
  least_thickness_ = thickness_;
  for (const Block& block : blocks_) {
    for (const Candidate& candidate : block.candidates) {
      if (candidate.thickness > 0.0) {
        least_thickness_ = std::min(least_thickness_, candidate.thickness);
      }
    }
  }
}

void SheetContactDetection::collect_around_vertex(int v, std::vector<Candidate>& candidates) const {
  triangle_tree_.for_each_meeting(box_of(v), [&](int t) {
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
  Candidate candidate{kind, particles, thickness_, false, 0.0};
  const bool is_joined = are_joined(kind, particles);
  const bool may_stick = wet_ != nullptr && kind == SimplexPair::kPointTriangle && !is_joined;
  // A guess: most are apart in the direction of their middles.
  const int first = kind == SimplexPair::kSegments ? 2 : 1;
  Eigen::Vector3d middles = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) {
    middles += start_.col(particles[k]) * (k < first ? 1.0 / first : -1.0 / (4 - first));
  }
  candidate.apart = (kUnit * middles.normalized()).cast<float>();
  if (!is_joined && !may_stick) return candidate;
  const FourPoints rest = corners_of(rest_, particles);
  const double apart = (rest * nearest_pair(kind, rest)).norm();
  if (is_joined) candidate.thickness = std::min(thickness_, kNearShare * apart);
  candidate.may_stick = may_stick && (pieces_[static_cast<std::size_t>(particles[0])] !=
                                          pieces_[static_cast<std::size_t>(particles[1])] ||
                                      kNearShare * apart > thickness_ + wet_->range);
  return candidate;
}

void SheetContactDetection::look(Block& block) const {
  block.found.clear();
  block.near.clear();
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
      end_vertex(first, block.found);
      first = block.found.size();
      vertex = candidate.particles[0];
    } else if (!is_vertex && vertex >= 0) {
      end_vertex(first, block.found);
      vertex = -1;
    }
    const double reach = candidate.thickness + margin_;
    const FourPoints start = corners_of(start_, candidate.particles);
    const FourPoints end = corners_of(end_, candidate.particles);
    Approach approach;
    approach.way.setZero();
    const Eigen::Vector3d apart = candidate.apart.cast<double>();
    approach.start = gap_along(candidate.kind, apart, start);
    const bool stays_apart =
        approach.start > reach && gap_along(candidate.kind, apart, end) > reach;
    const bool is_near = !stays_apart && find_approach(candidate.kind, start, end, reach, approach);
    // Both of its simplices may come as far as any vertex does.
    candidate.wake = path_ + 0.5 * (approach.start - reach);
    block.wake = std::min(block.wake, candidate.wake);
    if (!is_near) {
      if (!stays_apart) candidate.apart = (kUnit * approach.way.normalized()).cast<float>();
      continue;
    }
    block.near.push_back(
        {candidate.kind, candidate.particles, candidate.thickness, approach.start, approach.way});
    // At the ends of segments their vertices have contacts of their own.
    if (!is_vertex && !(approach.weights.cwiseAbs().minCoeff() > kWithin)) continue;
    block.found.push_back(
        {candidate.kind, candidate.particles, candidate.thickness, candidate.may_stick, approach});
  }
  if (vertex >= 0) end_vertex(first, block.found);
}

double SheetContactDetection::gap_along(SimplexPair kind, const Eigen::Vector3d& direction,
                                        const FourPoints& x) {
  const Eigen::RowVector4d at = direction.transpose() * x;
  return kind == SimplexPair::kSegments ? std::min(at[0], at[1]) - std::max(at[2], at[3])
                                        : at[0] - std::max({at[1], at[2], at[3]});
}

void SheetContactDetection::end_vertex(std::size_t first, std::vector<Found>& found) const {
  keep_first(first, found);
  if (wet_ != nullptr) stick(first, found);
}

void SheetContactDetection::stick(std::size_t first, std::vector<Found>& found) const {
  const auto nearest = [&](const Found* across) -> Found* {
    Found* best = nullptr;
    for (std::size_t k = first; k < found.size(); ++k) {
      Found& own = found[k];
      if (!own.may_stick || own.approach.start > own.thickness + wet_->range) continue;
      if (across != nullptr && own.approach.way.dot(across->approach.way) >= 0.0) continue;
      if (best == nullptr || own.approach.start < best->approach.start) best = &own;
    }
    return best;
  };
  Found* one = nearest(nullptr);
  if (one == nullptr) return;
  for (Found* side : {one, nearest(one)}) {
    if (side == nullptr) continue;
    for (int k = 0; k < 4; ++k) {
      side->pull += 0.25 * std::abs(side->approach.weights[k]) * wet_->pull[side->particles[k]];
    }
  }
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
  contact.pull = found.pull;
  if (wet_ != nullptr) {
    double grip = 0.0;
    for (int k = 0; k < 4; ++k) {
      grip += 0.5 * std::abs(found.approach.weights[k]) * wet_->grip[found.particles[k]];
    }
    contact.friction *= grip;
  }
  contact.start = contact.relative(start_);
  contact.least = found.thickness;
  if (found.approach.time == 0.0) {
    const double gap = contact.normal.dot(contact.start);
    contact.least = std::min(contact.least, gap + kMaxPushOutSpeed * dt);
  }
  return contact;
}

}  // namespace pliant
