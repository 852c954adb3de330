// What of a sheet comes near in a step.
#include <algorithm>
#include <limits>
#include <numeric>

#include "pliant/effects/self_contact/sheet_tree_search.h"

namespace pliant {

using namespace sheet_pairs;

void SheetTreeSearch::look(int patch, Block& block, Scratch& scratch) const {
  block.found.clear();
  block.near.clear();
  block.places.clear();
  look_at_candidates(block);
  if (!block.knows_around) look_around(patch, block, scratch);
  if (block.near.empty()) return;
  put_in_order(block, scratch);
  choose(block);
}

void SheetTreeSearch::look_at_candidates(Block& block) const {
  if (path_ + motion_ < block.wake) return;
  block.wake = std::numeric_limits<double>::infinity();
  for (Candidate& candidate : block.candidates) {
    if (!(candidate.thickness > 0.0)) continue;
    if (path_ + motion_ < candidate.wake) {
      block.wake = std::min(block.wake, candidate.wake);
      continue;
    }
    SheetNearPair near;
    const bool is_near =
        comes_near(candidate.kind, places(start_.data(), candidate.particles),
                   places(end_.data(), candidate.particles), candidate.thickness + margin_, path_,
                   candidate.gap, candidate.wake, near.approach);
    block.wake = std::min(block.wake, candidate.wake);
    if (!is_near) continue;
    near.kind = candidate.kind;
    std::copy(candidate.particles, candidate.particles + 4, near.particles);
    near.thickness = candidate.thickness;
    block.near.push_back(near);
    block.places.push_back(candidate.place);
  }
}

void SheetTreeSearch::look_around(int patch, Block& block, Scratch& scratch) const {
  scratch.bent.clear();
  patches_->find_bent(patch, start_.data(), end_.data(), nullptr, margin_, scratch.bent,
                      scratch.deviations);
  if (scratch.bent.empty()) return;
  look_around_vertices(patch, block, scratch);
  look_around_edges(patch, block, scratch);
}

template <class Vertices>
SheetTreeSearch::Box SheetTreeSearch::swept_box(const Vertices& vertices, double reach) const {
  Box box;
  for (const int i : vertices) {
    for (const Double3& x :
         {start_[static_cast<std::size_t>(i)], end_[static_cast<std::size_t>(i)]}) {
      box.extend(Eigen::Vector3d(x.x, x.y, x.z));
    }
  }
  box.min().array() -= reach;
  box.max().array() += reach;
  return box;
}

void SheetTreeSearch::look_around_vertices(int patch, Block& block, Scratch& scratch) const {
  Box all;
  scratch.boxes.clear();
  for (const int v : patches_->vertices(patch)) {
    scratch.boxes.push_back(swept_box(std::array<int, 1>{v}, 0.0));
    all.extend(scratch.boxes.back());
  }
  scratch.begin(static_cast<std::size_t>(mesh_.triangles.cols()));
  for (const int i : scratch.bent) {
    for (const int t : mesh_.triangles_of(i)) {
      if (!scratch.is_first(t)) continue;
      const auto c = mesh_.triangles.col(t);
      const Box swept = swept_box(c, thickness_ + margin_);
      if (!swept.intersects(all) || !patches_->is_around(patch, c)) continue;
      const Box* own = scratch.boxes.data();
      for (const int v : patches_->vertices(patch)) {
        if (!(own++)->intersects(swept) || (c.array() == v).any()) continue;
        look_at(SimplexPair::kPointTriangle, {v, c[0], c[1], c[2]},
                place_of(SimplexPair::kPointTriangle, v, t), block);
      }
    }
  }
}

void SheetTreeSearch::look_around_edges(int patch, Block& block, Scratch& scratch) const {
  Box all;
  scratch.boxes.clear();
  for (const int e : patches_->edges(patch)) {
    scratch.boxes.push_back(swept_box(mesh_.edges.col(e), 0.0));
    all.extend(scratch.boxes.back());
  }
  scratch.begin(static_cast<std::size_t>(mesh_.edges.cols()));
  for (const int i : scratch.bent) {
    for (const int other : mesh_.edges_of(i)) {
      if (!scratch.is_first(other)) continue;
      const auto b = mesh_.edges.col(other);
      const Box swept = swept_box(b, thickness_ + margin_);
      if (!swept.intersects(all) || !patches_->is_around(patch, b)) continue;
      const Box* own = scratch.boxes.data();
      for (const int e : patches_->edges(patch)) {
        if (!(own++)->intersects(swept) || other <= e) continue;
        const auto a = mesh_.edges.col(e);
        if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) continue;
        look_at(SimplexPair::kSegments, {a[0], a[1], b[0], b[1]},
                place_of(SimplexPair::kSegments, e, other), block);
      }
    }
  }
}

void SheetTreeSearch::look_at(SimplexPair kind, const std::array<int, 4>& particles, Place place,
                              Block& block) const {
  SheetNearPair near;
  near.kind = kind;
  std::copy(particles.begin(), particles.end(), near.particles);
  near.thickness = thickness_of(kind, near.particles);
  if (!(near.thickness > 0.0)) return;
  const PairPlaces start = places(start_.data(), near.particles);
  SheetGap gap = first_gap(kind, start);
  double wake = 0.0;
  if (!comes_near(kind, start, places(end_.data(), near.particles), near.thickness + margin_, path_,
                  gap, wake, near.approach)) {
    return;
  }
  block.near.push_back(near);
  block.places.push_back(place);
}

void SheetTreeSearch::put_in_order(Block& block, Scratch& scratch) {
  if (std::is_sorted(block.places.begin(), block.places.end())) return;
  scratch.order.resize(block.near.size());
  std::iota(scratch.order.begin(), scratch.order.end(), std::size_t{0});
  std::sort(scratch.order.begin(), scratch.order.end(),
            [&](std::size_t a, std::size_t b) { return block.places[a] < block.places[b]; });
  scratch.near.clear();
  scratch.places.clear();
  for (const std::size_t k : scratch.order) {
    scratch.near.push_back(block.near[k]);
    scratch.places.push_back(block.places[k]);
  }
  std::copy(scratch.near.begin(), scratch.near.end(), block.near.begin());
  std::copy(scratch.places.begin(), scratch.places.end(), block.places.begin());
}

void SheetTreeSearch::choose(Block& block) {
  std::vector<std::size_t>& found = block.found;
  std::size_t first = 0;  // in found, of the running vertex
  int own = -1;
  for (std::size_t k = 0; k < block.near.size(); ++k) {
    const SheetNearPair& near = block.near[k];
    if (block.places[k].own != own) first = found.size();
    own = block.places[k].own;
    const bool counts =
        near.is_vertex()
            ? std::none_of(
                  found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                  [&](std::size_t other) { return is_same_place(block.near[other], near); })
            : is_within(near.approach.weights);
    if (counts) found.push_back(k);
  }
}

}  // namespace pliant
