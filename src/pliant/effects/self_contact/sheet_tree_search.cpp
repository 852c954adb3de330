#include "pliant/effects/self_contact/sheet_tree_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pliant/core/columns.h"
#include "pliant/core/parallel/run_sum.h"

namespace pliant {
namespace {

using namespace sheet_pairs;

// The thickness is at most this share of the mean edge.
constexpr double kEdgeShare = 0.5;
// Of the mean edge: the slack up to which what lies around a patch is among its candidates. With
// more there were too many of them, for few steps.
constexpr double kSlow = 0.4;
// Patches that a thread takes at once.
constexpr int kPatches = 16;
// A patch knows the sheet around it so many times as far as boxes of its own and others reach.
constexpr double kAround = 1.5;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Eigen::Vector3d vector(const Double3& v) { return {v.x, v.y, v.z}; }

/// Where each box comes in the order of a tree.
std::vector<int> ranks_of(const BoxHierarchy& tree) {
  std::vector<int> ranks(tree.order().size());
  for (std::size_t k = 0; k < ranks.size(); ++k) ranks[at(tree.order()[k])] = static_cast<int>(k);
  return ranks;
}

template <class A, class B>
bool share_a_vertex(const A& a, const B& b) {
  return (a.array() == b[0]).any() || (a.array() == b[1]).any();
}

}  // namespace

SheetTreeSearch::SheetTreeSearch(const Positions& rest, const Eigen::Matrix3Xi& triangles,
                                 double thickness, double margin)
    : mesh_(rest, triangles),
      thickness_(std::min(thickness, kEdgeShare * mesh_.mean_edge)),
      margin_(margin),
      start_(mesh_.rest),
      end_(mesh_.rest),
      slacks_(mesh_.rest.size(), 0.0),
      least_thickness_(pliant::least_thickness(mesh_, thickness_)) {
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
  triangle_ranks_ = ranks_of(triangle_tree_);
  edge_ranks_ = ranks_of(edge_tree_);
}

void SheetTreeSearch::cut() {
  const double box = 0.5 * (thickness_ + margin_) + kMostSlack * mesh_.mean_edge;
  // Surfaces of several bodies do not meet themselves.
  const double far = bodies_ ? 0.0 : kAround * 2.0 * box + mesh_.mean_edge;
  patches_ = std::make_unique<SheetPatches>(mesh_, thickness_, far, triangle_tree_, edge_tree_);
  blocks_.resize(at(patches_->size()));
  if (bodies_) find_patch_bodies();
}

void SheetTreeSearch::find_patch_bodies() {
  patch_bodies_.clear();
  for (int p = 0; p < patches_->size(); ++p) {
    int body = -1;
    bool is_one = true;
    const auto take = [&](int vertex) {
      if (body < 0) body = bodies_->body_of(vertex);
      is_one &= body == bodies_->body_of(vertex);
    };
    for (const int v : patches_->vertices(p)) take(v);
    for (const int e : patches_->edges(p)) take(mesh_.edges(0, e));
    patch_bodies_.push_back(is_one ? body : -1);
  }
}

void SheetTreeSearch::enclose_bodies() {
  body_boxes_.assign(at(bodies_->pairs.bodies()), Box());
  for (int i = 0; i < mesh_.vertices(); ++i) {
    body_boxes_[at(bodies_->body_of(i))].extend(box_of(i));
  }
}

SheetTreeSearch::Box SheetTreeSearch::box_of_others(int patch, const Box& box) const {
  const int own = bodies_ ? patch_bodies_[at(patch)] : -1;
  if (own < 0) return box;
  Box near;
  for (int other = 0; other < bodies_->pairs.bodies(); ++other) {
    if (!bodies_->pairs.touches(own, other)) continue;
    const Box& theirs = body_boxes_[at(other)];
    if (theirs.intersects(box)) near.extend(theirs.intersection(box));
  }
  return near;
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
  parallel_for(0, static_cast<int>(simplices.cols()), kLoopGrain, [&](int begin, int end) {
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
  Double3 displacement = {0.0, 0.0, 0.0};
  if (!collected_start_.empty()) {
    displacement = sum_by_runs(
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
          part.path = greater(part.path, norm(start[i] - start_[at(i)] - displacement));
          start_[at(i)] = start[i];
          end_[at(i)] = end[i] - mean_motion_;
          part.motion = greater(part.motion, norm(end_[at(i)] - start_[at(i)]));
          if (collected_start_.empty()) continue;
          // The frame of the candidates moves with the sheet.
          collected_start_[at(i)] += displacement;
          collected_end_[at(i)] += displacement;
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
                is_near_path(x, collected_start_[at(i)], collected_end_[at(i)], slacks_[at(i)]);
            if (!is_near) return 1;
          }
        }
        return 0;
      },
      [](int a, int b) { return a + b; });
  return far == 0;
}

SheetNearPairs SheetTreeSearch::find(const Positions& start, const Positions& end) {
  search(places_in(start), places_in(end));
  return gather();
}

void SheetTreeSearch::search(const Double3* start, const Double3* end) {
  if (!patches_) cut();
  follow(start, end);
  if (!are_candidates_good()) collect();
  parallel_for(0, patches_->size(), kPatches, [&](int begin, int last) {
    thread_local Scratch scratch;
    for (int p = begin; p < last; ++p) look(p, blocks_[at(p)], scratch);
  });
}

SheetNearPairs SheetTreeSearch::gather() {
  // Of each vertex and edge one block has all.
  begins_.assign(mesh_.rest.size() + at(static_cast<int>(mesh_.edges.cols())) + 1, 0);
  for (const Block& block : blocks_) {
    for (const std::size_t k : block.found) ++begins_[at(block.places[k].own) + 1];
  }
  for (std::size_t k = 1; k < begins_.size(); ++k) begins_[k] += begins_[k - 1];
  found_.resize(begins_.back());
  parallel_for(0, static_cast<int>(blocks_.size()), kPatches, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      const Block& block = blocks_[at(b)];
      for (const std::size_t k : block.found) {
        found_[begins_[at(block.places[k].own)]++] = block.near[k];
      }
    }
  });
  return {found_.data(), found_.size()};
}

void SheetTreeSearch::collect() {
  parallel_for(0, mesh_.vertices(), kLoopGrain, [&](int begin, int end) {
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
  if (bodies_) enclose_bodies();
  parallel_for(0, patches_->size(), kPatches, [&](int begin, int end) {
    thread_local Scratch scratch;
    for (int p = begin; p < end; ++p) collect(p, blocks_[at(p)], scratch);
  });
  if (bodies_) least_thickness_ = least_of_candidates();
}

double SheetTreeSearch::least_of_candidates() const {
  double least = thickness_;
  for (const Block& block : blocks_) {
    for (const Candidate& candidate : block.candidates) {
      if (candidate.thickness > 0.0) least = std::min(least, candidate.thickness);
    }
  }
  return least;
}

void SheetTreeSearch::collect(int patch, Block& block, Scratch& scratch) const {
  scratch.is_bent.resize(start_.size(), 0);
  scratch.bent.clear();
  block.knows_around = true;
  for (const int v : patches_->vertices(patch)) {
    block.knows_around &= slacks_[at(v)] <= kSlow * mesh_.mean_edge;
  }
  if (block.knows_around) {
    patches_->find_bent(patch, start_.data(), end_.data(), slacks_.data(), margin_, scratch.bent,
                        scratch.deviations);
  }
  for (const int i : scratch.bent) scratch.is_bent[at(i)] = 1;
  block.candidates.clear();
  block.wake = 0.0;
  collect_of_vertices(patch, block, scratch);
  collect_of_edges(patch, block, scratch);
  for (const int i : scratch.bent) scratch.is_bent[at(i)] = 0;
}

template <class Simplices>
void SheetTreeSearch::find_strangers(int patch, const BoxHierarchy& tree,
                                     const Simplices& simplices, const Box& box,
                                     Scratch& scratch) const {
  scratch.strangers.clear();
  const Box near = box_of_others(patch, box);
  if (near.isEmpty()) return;
  const int own = bodies_ ? patch_bodies_[at(patch)] : -1;
  tree.for_each_overlapping(near, [&](int s) {
    const auto simplex = simplices.col(s);
    if (own >= 0 && !bodies_->pairs.touches(own, bodies_->body_of(simplex[0]))) return;
    const bool is_bent =
        std::any_of(simplex.begin(), simplex.end(), [&](int i) { return scratch.is_bent[at(i)]; });
    if (is_bent || !patches_->is_around(patch, simplex)) scratch.strangers.push_back(s);
  });
}

void SheetTreeSearch::collect_of_vertices(int patch, Block& block, Scratch& scratch) const {
  Box all;
  for (const int v : patches_->vertices(patch)) all.extend(box_of(v));
  find_strangers(patch, triangle_tree_, mesh_.triangles, all, scratch);
  if (scratch.strangers.empty()) return;
  for (const int v : patches_->vertices(patch)) {
    const Box own = box_of(v);
    for (const int t : scratch.strangers) {
      const auto c = mesh_.triangles.col(t);
      if (!may_meet(v, c[0]) || (c.array() == v).any()) continue;
      if (!triangle_boxes_[at(t)].intersects(own)) continue;
      block.candidates.push_back(candidate(SimplexPair::kPointTriangle, {v, c[0], c[1], c[2]},
                                           place_of(SimplexPair::kPointTriangle, v, t)));
    }
  }
}

void SheetTreeSearch::collect_of_edges(int patch, Block& block, Scratch& scratch) const {
  Box all;
  for (const int e : patches_->edges(patch)) all.extend(edge_boxes_[at(e)]);
  find_strangers(patch, edge_tree_, mesh_.edges, all, scratch);
  if (scratch.strangers.empty()) return;
  for (const int e : patches_->edges(patch)) {
    const auto a = mesh_.edges.col(e);
    for (const int other : scratch.strangers) {
      const auto b = mesh_.edges.col(other);
      if (other <= e || !may_meet(a[0], b[0]) || share_a_vertex(a, b)) continue;
      if (!edge_boxes_[at(other)].intersects(edge_boxes_[at(e)])) continue;
      block.candidates.push_back(candidate(SimplexPair::kSegments, {a[0], a[1], b[0], b[1]},
                                           place_of(SimplexPair::kSegments, e, other)));
    }
  }
}

SheetTreeSearch::Place SheetTreeSearch::place_of(SimplexPair kind, int own, int other) const {
  return kind == SimplexPair::kPointTriangle
             ? Place{own, triangle_ranks_[at(other)]}
             : Place{mesh_.vertices() + own, edge_ranks_[at(other)]};
}

SheetTreeSearch::Candidate SheetTreeSearch::candidate(SimplexPair kind,
                                                      const std::array<int, 4>& particles,
                                                      Place place) const {
  Candidate candidate{kind, {}, place, 0.0, 0.0, {}};
  std::copy(particles.begin(), particles.end(), candidate.particles);
  candidate.thickness = thickness_of(kind, candidate.particles);
  candidate.gap = first_gap(kind, places(start_.data(), candidate.particles));
  return candidate;
}

double SheetTreeSearch::thickness_of(SimplexPair kind, const int* particles) const {
  return bodies_ ? bodies_->kept(particles[0], particles[3])
                 : sheet_pairs::thickness_of(mesh_.joints(), kind, particles, thickness_);
}

}  // namespace pliant
