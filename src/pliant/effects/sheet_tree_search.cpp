#include "pliant/effects/sheet_tree_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/columns.h"
#include "pliant/core/run_sum.h"

namespace pliant {
namespace {

using namespace sheet_pairs;

// The thickness is at most this share of the mean edge.
constexpr double kEdgeShare = 0.5;
// Vertices or edges that a thread takes at once.
constexpr int kBlock = 256;
// Blocks whose meetings a thread copies.
constexpr int kGatherGrain = 16;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Eigen::Vector3d vector(const Double3& v) { return {v.x, v.y, v.z}; }

}  // namespace

SheetTreeSearch::SheetTreeSearch(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                                 double thickness, double margin)
    : mesh_(rest, triangles),
      thickness_(std::min(thickness, kEdgeShare * mesh_.mean_edge)),
      margin_(margin),
      start_(mesh_.rest),
      end_(mesh_.rest),
      slacks_(mesh_.rest.size(), 0.0) {
  build_trees();
}

SheetTreeSearch::SheetTreeSearch(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                                 SheetBodies bodies, double margin)
    : mesh_(rest, triangles),
      bodies_(std::move(bodies)),
      thickness_(2.0 * *std::max_element(bodies_->half.begin(), bodies_->half.end())),
      margin_(margin),
      start_(mesh_.rest),
      end_(mesh_.rest),
      slacks_(mesh_.rest.size(), 0.0) {
  build_trees();
}

void SheetTreeSearch::build_trees() {
  enclose(mesh_.triangles, triangle_boxes_);
  enclose(mesh_.edges, edge_boxes_);
  triangle_tree_.build(triangle_boxes_);
  edge_tree_.build(edge_boxes_);
}

SheetTreeSearch::Box SheetTreeSearch::box_of(int vertex) const {
  Box box(vector(start_[at(vertex)]));
  box.extend(vector(end_[at(vertex)]));
  const double half = half_thickness(vertex) + 0.5 * margin_ + slacks_[at(vertex)];
  box.min().array() -= half;
  box.max().array() += half;
  return box;
}

template <int kCorners>
void SheetTreeSearch::enclose(const Eigen::Matrix<int, kCorners, Eigen::Dynamic>& simplices,
                              std::vector<Box>& boxes) const {
  boxes.resize(static_cast<std::size_t>(simplices.cols()));
  parallel_for(0, static_cast<int>(simplices.cols()), kColumnGrain, [&](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      Box box;
      for (int k = 0; k < kCorners; ++k) box.extend(box_of(simplices(k, s)));
      boxes[at(s)] = box;
    }
  });
}

void SheetTreeSearch::follow(const Double3* start, const Double3* end) {
  const int count = mesh_.vertices();
  const auto n = static_cast<double>(count);
  Double3 way = {0.0, 0.0, 0.0};
  if (!collected_start_.empty()) {
    way = sum_by_runs(
              count, [&](int i) { return start[i] - start_[at(i)]; }, sums_) /
          n;
  }
  mean_motion_ = sum_by_runs(
                     count, [&](int i) { return end[i] - start[i]; }, sums_) /
                 n;
  struct Most {
    double path = 0.0, motion = 0.0;
  };
  const Most most = parallel_reduce(
      0, count, kColumnGrain,
      [&](int from, int to) {
        Most part;
        for (int i = from; i < to; ++i) {
          part.path = greater(part.path, norm(start[i] - start_[at(i)] - way));
          start_[at(i)] = start[i];
          end_[at(i)] = end[i] - mean_motion_;
          part.motion = greater(part.motion, norm(end_[at(i)] - start_[at(i)]));
          if (collected_start_.empty()) continue;
          // The frame of the candidates moves with the sheet.
          collected_start_[at(i)] += way;
          collected_end_[at(i)] += way;
        }
        return part;
      },
      [](const Most& a, const Most& b) {
        return Most{greater(a.path, b.path), greater(a.motion, b.motion)};
      });
  path_ += most.path;
  motion_ = most.motion;
}

bool SheetTreeSearch::are_candidates_good() const {
  if (collected_start_.empty()) return false;
  const int far = parallel_reduce(
      0, mesh_.vertices(), kColumnGrain,
      [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
          for (const Double3& x : {end_[at(i)], start_[at(i)]}) {
            const bool is_near =
                is_near_way(x, collected_start_[at(i)], collected_end_[at(i)], slacks_[at(i)]);
            if (!is_near) return 1;
          }
        }
        return 0;
      },
      [](int a, int b) { return a + b; });
  return far == 0;
}

SheetMeetings SheetTreeSearch::find(const Positions& start, const Positions& end) {
  search(places_in(start), places_in(end));
  return gather();
}

void SheetTreeSearch::search(const Double3* start, const Double3* end) {
  follow(start, end);
  if (!are_candidates_good()) collect();
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end_block) {
    for (int b = begin; b < end_block; ++b) look(blocks_[at(b)]);
  });
}

SheetMeetings SheetTreeSearch::gather() {
  begins_.assign(1, 0);
  for (const Block& block : blocks_) begins_.push_back(begins_.back() + block.found.size());
  found_.resize(begins_.back());
  parallel_for(0, static_cast<int>(blocks_.size()), kGatherGrain, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      std::size_t next = begins_[at(b)];
      for (const std::size_t k : blocks_[at(b)].found) found_[next++] = blocks_[at(b)].near[k];
    }
  });
  return {found_.data(), found_.size()};
}

void SheetTreeSearch::collect() {
  const int vertices = mesh_.vertices(), edges = static_cast<int>(mesh_.edges.cols());
  parallel_for(0, vertices, kColumnGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      slacks_[at(i)] = slack(start_[at(i)], end_[at(i)], mesh_.mean_edge);
    }
  });
  collected_start_ = start_;
  collected_end_ = end_;
  enclose(mesh_.triangles, triangle_boxes_);
  enclose(mesh_.edges, edge_boxes_);
  triangle_tree_.refit(triangle_boxes_);
  edge_tree_.refit(edge_boxes_);
  blocks_.resize(static_cast<std::size_t>((vertices + edges + kBlock - 1) / kBlock));
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      std::vector<Candidate>& candidates = blocks_[at(b)].candidates;
      candidates.clear();
      blocks_[at(b)].wake = 0.0;
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

void SheetTreeSearch::collect_around_vertex(int v, std::vector<Candidate>& candidates) const {
  triangle_tree_.for_each_meeting(box_of(v), [&](int t) {
    const auto corners = mesh_.triangles.col(t);
    if (!may_meet(v, corners[0]) || (corners.array() == v).any()) return;
    candidates.push_back(
        candidate(SimplexPair::kPointTriangle, {v, corners[0], corners[1], corners[2]}));
  });
}

void SheetTreeSearch::collect_around_edge(int e, std::vector<Candidate>& candidates) const {
  const auto own = mesh_.edges.col(e);
  edge_tree_.for_each_meeting(edge_boxes_[at(e)], [&](int other) {
    if (other <= e) return;
    const auto edge = mesh_.edges.col(other);
    if (!may_meet(own[0], edge[0]) || (edge.array() == own[0]).any() ||
        (edge.array() == own[1]).any())
      return;
    candidates.push_back(candidate(SimplexPair::kSegments, {own[0], own[1], edge[0], edge[1]}));
  });
}

SheetTreeSearch::Candidate SheetTreeSearch::candidate(SimplexPair kind,
                                                      const Eigen::Vector4i& particles) const {
  Candidate candidate{kind, {particles[0], particles[1], particles[2], particles[3]}, 0.0, 0.0, {}};
  candidate.thickness = bodies_
                            ? bodies_->kept(particles[0], particles[3])
                            : thickness_of(mesh_.joints(), kind, candidate.particles, thickness_);
  candidate.gap = first_gap(kind, places(start_.data(), candidate.particles));
  return candidate;
}

void SheetTreeSearch::look(Block& block) const {
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
    SheetMeeting near;
    const bool is_near =
        comes_near(candidate.kind, places(start_.data(), candidate.particles),
                   places(end_.data(), candidate.particles), candidate.thickness + margin_, path_,
                   candidate.gap, candidate.wake, near.approach);
    block.wake = std::min(block.wake, candidate.wake);
    if (!is_near) continue;
    near.kind = candidate.kind;
    std::copy(candidate.particles, candidate.particles + 4, near.particles);
    near.thickness = candidate.thickness;
    const int own = near.is_vertex() ? near.particles[0] : -1;
    if (own != vertex) {
      if (vertex >= 0) keep_first(first, block);
      first = block.found.size();
      vertex = own;
    }
    if (near.is_vertex() || is_within(near.approach.weights)) {
      block.found.push_back(block.near.size());
    }
    block.near.push_back(near);
  }
  if (vertex >= 0) keep_first(first, block);
}

void SheetTreeSearch::keep_first(std::size_t first, Block& block) {
  std::vector<std::size_t>& found = block.found;
  std::size_t kept = first;
  for (std::size_t k = first; k < found.size(); ++k) {
    const bool is_new = std::none_of(
        found.begin() + static_cast<std::ptrdiff_t>(first),
        found.begin() + static_cast<std::ptrdiff_t>(kept),
        [&](std::size_t other) { return is_same_place(block.near[other], block.near[found[k]]); });
    if (is_new) found[kept++] = found[k];
  }
  found.resize(kept);
}

}  // namespace pliant
