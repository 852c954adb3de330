// How far a sheet may go without passing through itself.
#include <algorithm>
#include <cmath>

#include "pliant/effects/sheet_contact_detection.h"

namespace pliant {
namespace {

// Of the thickness, and of the distance at the start where that is less: what pairs keep all the
// way.
constexpr double kKept = 0.1, kKeptOfStart = 0.5;
// Nearer than this share of the thickness they come no nearer, but for what round-off needs: else
// they would soon touch, and have no sides.
constexpr double kTight = 1e-3, kKeptOfTight = 0.999;
// Places nearer than this share of the thickness have no sides.
constexpr double kTouching = 1e-6;
// Of the way to where a pair would be too near, and of the time that it takes.
constexpr double kGone = 0.8;
// How often the ways of what would pass are shortened before it stays where it is, and until all
// does.
constexpr int kShortened = 6, kStopped = 24;
// Of what counts as near: with ends that moved by no more, nothing else passes.
constexpr double kSeen = 0.35;

FourPoints corners_of(const Positions& x, const Eigen::Vector4i& particles) {
  FourPoints corners;
  for (int k = 0; k < 4; ++k) corners.col(k) = x.col(particles[k]);
  return corners;
}

}  // namespace

bool SheetContactDetection::is_seen(const Positions& x) const {
  const double most = kSeen * (least_thickness_ + margin_);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if ((x.col(i) - end_.col(i) - mean_motion_).squaredNorm() > most * most) return false;
  }
  return true;
}

bool SheetContactDetection::passes(const Near& near, const FourPoints& start, const FourPoints& end,
                                   double& time) {
  if (near.start <= kTouching * near.thickness) return false;
  const bool is_tight = near.start < kTight * near.thickness;
  const double kept = is_tight ? kKeptOfTight * near.start
                               : std::min(kKept * near.thickness, kKeptOfStart * near.start);
  const Eigen::Vector3d along = near.way.stableNormalized();
  if (gap_along(near.kind, along, start) >= kept && gap_along(near.kind, along, end) >= kept) {
    return false;
  }
  time = 0.0;
  if (is_tight) return true;
  Approach approach;
  const bool comes_near = find_approach(near.kind, start, end, kept, approach);
  time = approach.time;
  return comes_near;
}

bool SheetContactDetection::shorten(const Positions& x, bool stop) {
  cuts_.setOnes(x.cols());
  bool any = false;
  for (const Block& block : blocks_) {
    for (const Near& near : block.near) {
      double time = 0.0;
      if (!passes(near, corners_of(start_, near.particles), corners_of(x, near.particles), time)) {
        continue;
      }
      any = true;
      for (const int i : near.particles) {
        cuts_[i] = stop ? 0.0 : std::min(cuts_[i], kGone * time);
      }
    }
  }
  if (any) shares_.array() *= cuts_.array();
  return any;
}

bool SheetContactDetection::advance(const Particles& particles, double dt, Positions& x,
                                    std::vector<PairContact>& contacts) {
  if (!is_seen(x)) search(start_, x);
  shares_.setOnes(x.cols());
  if (!shorten(x, false)) return true;
  wanted_ = x;
  for (int round = 1; round <= kStopped; ++round) {
    for (int i = 0; i < x.cols(); ++i) {
      if (!particles.is_fixed(i)) {
        x.col(i) = start_.col(i) + shares_[i] * (wanted_.col(i) - start_.col(i));
      }
    }
    search(start_, x);
    if (!shorten(x, round >= kShortened)) break;
    if (round + 1 == kStopped) shares_.setZero();
  }
  search(x, wanted_);
  make_contacts(dt, contacts);
  return false;
}

}  // namespace pliant
