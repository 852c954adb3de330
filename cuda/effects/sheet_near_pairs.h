#pragma once

#include "cuda/effects/sheet_candidates.h"

/// What comes near, and how far vertices may go: kernels of DeviceSheetSearch.
namespace pliant {

/// What a look at the candidates goes by.
struct SheetLook {
  SheetCandidates candidates;
  const Double3 *start, *end;
  double path, motion, margin;  ///< [m]
};

namespace sheet_kernels {

/// Flags candidates that have to be looked at: no others can be near.
struct WakeCandidates {
  SheetLook look;
  unsigned char* flags;
  PLIANT_HOST_DEVICE void operator()(int c) const {
    const SheetCandidates& all = look.candidates;
    flags[c] = 0;
    if (look.path + look.motion < all.wake[c]) return;
    const Int4 own = all.particles[c];
    const double reach = all.thickness[c] + look.margin;
    double gap = 0.0;
    const bool stays =
        sheet_pairs::stays_apart(all.kind(c), all.gap[c], sheet_pairs::places(look.start, own.v),
                                 sheet_pairs::places(look.end, own.v), reach, gap);
    if (stays) {
      all.wake[c] = sheet_pairs::wake_after(look.path, gap, reach);
    } else {
      flags[c] = 1;
    }
  }
};

PLIANT_HOST_DEVICE inline bool look_at(const SheetLook& look, int c, PairApproach& approach) {
  const SheetCandidates& all = look.candidates;
  const Int4 own = all.particles[c];
  return sheet_pairs::comes_near(
      all.kind(c), sheet_pairs::places(look.start, own.v), sheet_pairs::places(look.end, own.v),
      all.thickness[c] + look.margin, look.path, all.gap[c], all.wake[c], approach);
}

/// Flags, of some candidates, those that come near.
struct LookAtCandidates {
  SheetLook look;
  const int* list;
  unsigned char* flags;
  PLIANT_HOST_DEVICE void operator()(int k) const {
    PairApproach approach;
    flags[k] = look_at(look, list[k], approach) ? 1 : 0;
  }
};

/// Of those once more, which takes less memory than to keep all: they are few.
struct GatherNear {
  SheetLook look;
  const int* awake;
  const int* list;  ///< of those awake
  SheetNearPair* near;
  PLIANT_HOST_DEVICE void operator()(int k) const {
    const int c = awake[list[k]];
    SheetNearPair own;
    own.kind = look.candidates.kind(c);
    for (int p = 0; p < 4; ++p) own.particles[p] = look.candidates.particles[c].v[p];
    own.thickness = look.candidates.thickness[c];
    look_at(look, c, own.approach);
    near[k] = own;
  }
};

/// Flags what makes a contact; the first pair of a vertex decides for all of them.
struct KeepFirst {
  const SheetNearPair* near;
  int size;
  unsigned char* flags;

  PLIANT_HOST_DEVICE void operator()(int k) const {
    if (!near[k].is_vertex()) {
      flags[k] = sheet_pairs::is_within(near[k].approach.weights) ? 1 : 0;
      return;
    }
    if (k > 0 && is_of(k - 1, near[k].particles[0])) return;
    for (int own = k; own < size && is_of(own, near[k].particles[0]); ++own) {
      flags[own] = is_new(k, own) ? 1 : 0;
    }
  }

 private:
  PLIANT_HOST_DEVICE bool is_of(int k, int vertex) const {
    return near[k].is_vertex() && near[k].particles[0] == vertex;
  }
  PLIANT_HOST_DEVICE bool is_new(int first, int own) const {
    for (int other = first; other < own; ++other) {
      if (flags[other] != 0 && sheet_pairs::is_same_place(near[other], near[own])) return false;
    }
    return true;
  }
};

struct GatherFound {
  const SheetNearPair* near;
  const int* list;
  SheetNearPair* found;
  PLIANT_HOST_DEVICE void operator()(int k) const { found[k] = near[list[k]]; }
};

/// Shares of their displacements that vertices may go.
struct SheetShares {
  double* shares;
  SharedExtreme* cuts;  ///< of the shares, in this round
};

struct BeginShares {
  SheetShares shares;
  bool is_first;  ///< round
  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (is_first) shares.shares[i] = 1.0;
    shares.cuts[i] = SharedExtreme::of(1.0);
  }
};

/// As SheetTreeSearch::shorten().
struct Shorten {
  const SheetNearPair* near;
  const Double3 *start, *x;
  bool stop;
  SheetShares shares;
  SheetTally* tally;
  PLIANT_HOST_DEVICE void operator()(int k) const {
    const SheetNearPair own = near[k];
    double time = 0.0;
    const bool passes = sheet_pairs::passes(own, sheet_pairs::places(start, own.particles),
                                            sheet_pairs::places(x, own.particles), time);
    if (!passes) return;
    tally->passes = 1;
    for (const int i : own.particles) {
      shares.cuts[i].lower(stop ? 0.0 : sheet_pairs::kGone * time);
    }
  }
};

/// To where each vertex may go; fixed ones stay where they are put.
struct MoveBack {
  const Double3 *start, *wanted;
  const unsigned char* fixed;
  SheetShares shares;
  bool all;  ///< go nowhere
  Double3* x;
  PLIANT_HOST_DEVICE void operator()(int i) const {
    shares.shares[i] = all ? 0.0 : shares.shares[i] * shares.cuts[i].value();
    if (fixed[i] == 0) x[i] = start[i] + shares.shares[i] * (wanted[i] - start[i]);
  }
};

struct CopyPlaces {
  const Double3* from;
  Double3* to;
  PLIANT_HOST_DEVICE void operator()(int i) const { to[i] = from[i]; }
};

}  // namespace sheet_kernels
}  // namespace pliant
