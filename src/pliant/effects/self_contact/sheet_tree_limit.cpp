// How far a sheet may go without passing through itself.
#include <algorithm>

#include "pliant/core/columns.h"
#include "pliant/effects/self_contact/sheet_tree_search.h"

namespace pliant {

using namespace sheet_pairs;

bool SheetTreeSearch::is_seen(const Double3* x) const {
  const double most = kSeen * (least_thickness_ + margin_);
  const int far = parallel_reduce(
      0, mesh_.vertices(), kColumnGrain,
      [&](int begin, int end) {
        for (int i = begin; i < end; ++i) {
          const Double3 off = x[i] - end_[static_cast<std::size_t>(i)] - mean_motion_;
          if (squared_norm(off) > most * most) return 1;
        }
        return 0;
      },
      [](int a, int b) { return a + b; });
  return far == 0;
}

void SheetTreeSearch::look_for_passages(const Double3* x, Block& block) const {
  block.passages.clear();
  for (std::size_t k = 0; k < block.near.size(); ++k) {
    const SheetNearPair& near = block.near[k];
    double time = 0.0;
    if (passes(near, places(start_.data(), near.particles), places(x, near.particles), time)) {
      block.passages.push_back({k, time});
    }
  }
}

bool SheetTreeSearch::shorten(const Double3* x, bool stop) {
  parallel_for(0, static_cast<int>(blocks_.size()), 1, [&](int begin, int end) {
    for (int b = begin; b < end; ++b) {
      look_for_passages(x, blocks_[static_cast<std::size_t>(b)]);
    }
  });
  cuts_.assign(start_.size(), 1.0);
  bool any = false;
  for (const Block& block : blocks_) {
    for (const Passage& passage : block.passages) {
      any = true;
      for (const int i : block.near[passage.near].particles) {
        double& cut = cuts_[static_cast<std::size_t>(i)];
        cut = stop ? 0.0 : std::min(cut, kGone * passage.time);
      }
    }
  }
  for (std::size_t i = 0; any && i < shares_.size(); ++i) shares_[i] *= cuts_[i];
  return any;
}

bool SheetTreeSearch::limit_displacement(const Particles& particles, Positions& x,
                                         SheetNearPairs& found) {
  const auto place = [&](const std::vector<double>& shares, Positions& at) {
    for (int i = 0; i < at.cols(); ++i) {
      if (particles.is_fixed(i)) continue;
      const auto k = static_cast<std::size_t>(i);
      const Double3 there = start_[k] + shares[k] * (wanted_[k] - start_[k]);
      at.col(i) << there.x, there.y, there.z;
    }
  };
  return limit_displacement(place, x, found);
}

bool SheetTreeSearch::limit_displacement(const Placement& place, Positions& x,
                                         SheetNearPairs& found) {
  const Double3* to = places_in(x);
  if (!is_seen(to)) search(start_.data(), to);
  shares_.assign(start_.size(), 1.0);
  if (!shorten(to, false)) return true;
  wanted_.assign(to, to + x.cols());
  for (int round = 1; round <= kStopped; ++round) {
    place(shares_, x);
    search(start_.data(), to);
    if (!shorten(to, round >= kShortened)) break;
    if (round + 1 == kStopped) std::fill(shares_.begin(), shares_.end(), 0.0);
  }
  search(to, wanted_.data());
  found = gather();
  return false;
}

}  // namespace pliant
