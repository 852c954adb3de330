#pragma once

#include "pliant/geometry/search/simplex_pair.h"

/// What the search of a sheet's contacts with itself does with a single pair, a vertex and a
/// triangle or two edges: one source for CPU and GPU.
namespace pliant {

/// Four particles that come near in this step.
struct SheetNearPair {
  SimplexPair kind;
  int particles[4];
  double thickness;  ///< that they keep [m]
  PairApproach approach;

  PLIANT_HOST_DEVICE bool is_vertex() const { return kind == SimplexPair::kPointTriangle; }
};

/// A direction no longer than 1 in which the first simplex lay beyond the second when they were
/// looked at; zero: not known.
struct SheetGap {
  float x, y, z;
};

/// Who is joined to whom; see SheetMesh.
struct SheetJoints {
  const Double3* rest;
  const int* begins;
  const int* neighbors;

  PLIANT_HOST_DEVICE bool share_an_edge(int a, int b) const {
    int low = begins[a], high = begins[a + 1];
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (neighbors[middle] == b) return true;
      if (neighbors[middle] < b) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return false;
  }
  PLIANT_HOST_DEVICE bool are_joined(SimplexPair kind, const int* particles) const {
    for (int a = 0; a < first_of(kind); ++a) {
      for (int b = first_of(kind); b < 4; ++b) {
        if (share_an_edge(particles[a], particles[b])) return true;
      }
    }
    return false;
  }
};

namespace sheet_pairs {

// What is joined by an edge touches below this share of its distance at rest.
constexpr double kNearShare = 0.5;
// How far a vertex may go before candidates are collected anew: so many times its displacement in
// this step, within these shares of the mean edge.
constexpr double kStepsAhead = 8.0, kLeastSlack = 0.1, kMostSlack = 0.6;
// Nearest points that agree to this share of the thickness are one.
constexpr double kSamePlace = 1e-9;
// Segments are nearest within both but for this share of their lengths; at their ends the vertices
// have contacts of their own.
constexpr double kWithin = 1e-9;
// Length of a direction in single precision: surely not above 1.
constexpr double kUnit = 1.0 - 1e-6;
// Of the thickness, and of the distance at the start where that is less: what pairs keep on the
// whole path.
constexpr double kKept = 0.1, kKeptOfStart = 0.5;
// Nearer than this share of the thickness they come no nearer, but for what round-off needs: else
// they would soon touch, and have no sides.
constexpr double kTight = 1e-3, kKeptOfTight = 0.999;
// Places nearer than this share of the thickness have no sides.
constexpr double kTouching = 1e-6;
// Of the path to where a pair would be too near, and of the time that it takes.
constexpr double kGone = 0.8;
// How often the paths of what would pass are shortened before it stays where it is, and until all
// does.
constexpr int kShortened = 6, kStopped = 24;
// Of what counts as near: with ends that moved by no more, nothing else passes.
constexpr double kSeen = 0.35;

PLIANT_HOST_DEVICE inline PairPlaces places(const Double3* x, const int* particles) {
  PairPlaces places;
  for (int k = 0; k < 4; ++k) places.at[k] = x[particles[k]];
  return places;
}

/// How far a vertex may leave its path until candidates are collected anew [m].
PLIANT_HOST_DEVICE inline double slack(const Double3& start, const Double3& end, double mean_edge) {
  return clamped(kStepsAhead * norm(end - start), kLeastSlack * mean_edge, kMostSlack * mean_edge);
}

/// Whether x is no farther than `slack` from the straight path that was known.
PLIANT_HOST_DEVICE inline bool is_near_path(const Double3& x, const Double3& start,
                                            const Double3& end, double slack) {
  const double squared = slack * slack;
  if (squared_norm(x - end) <= squared) return true;
  // Boxes enclose the whole path, so that a part of it is known too.
  const Double3 displacement = end - start, from = x - start;
  const double length = squared_norm(displacement);
  const double part = length > 0.0 ? clamped(dot(from, displacement) / length, 0.0, 1.0) : 0.0;
  return squared_norm(from - part * displacement) <= squared;
}

/// How far the first simplex is beyond the second along a direction no longer than 1: they are no
/// nearer, nor is what moves straight on between two such states.
PLIANT_HOST_DEVICE inline double gap_along(SimplexPair kind, const Double3& direction,
                                           const PairPlaces& x) {
  double at[4];
  for (int k = 0; k < 4; ++k) at[k] = dot(direction, x.at[k]);
  return kind == SimplexPair::kSegments ? lesser(at[0], at[1]) - greater(at[2], at[3])
                                        : at[0] - greater(greater(at[1], at[2]), at[3]);
}

PLIANT_HOST_DEVICE inline SheetGap gap_of(const Double3& between) {
  const Double3 unit = kUnit * normalized(between);
  return {static_cast<float>(unit.x), static_cast<float>(unit.y), static_cast<float>(unit.z)};
}

/// A guess: most are apart in the direction of their middles.
PLIANT_HOST_DEVICE inline SheetGap first_gap(SimplexPair kind, const PairPlaces& x) {
  const int first = first_of(kind);
  Double3 middles = {0.0, 0.0, 0.0};
  for (int k = 0; k < 4; ++k) {
    middles += (k < first ? 1.0 / first : -1.0 / (4 - first)) * x.at[k];
  }
  return gap_of(middles);
}

/// At rest [m].
PLIANT_HOST_DEVICE inline double rest_distance(const SheetJoints& joints, SimplexPair kind,
                                               const int* particles) {
  const PairPlaces x = places(joints.rest, particles);
  return norm(offset_between(x, nearest_weights(kind, x)));
}

/// That a pair keeps, of a sheet's [m]; 0: nothing.
PLIANT_HOST_DEVICE inline double thickness_of(const SheetJoints& joints, SimplexPair kind,
                                              const int* particles, double thickness) {
  if (!joints.are_joined(kind, particles)) return thickness;
  return lesser(thickness, kNearShare * rest_distance(joints, kind, particles));
}

/// Whether they stay farther apart than `reach` on their straight paths by what is known of them.
PLIANT_HOST_DEVICE inline bool stays_apart(SimplexPair kind, const SheetGap& gap,
                                           const PairPlaces& start, const PairPlaces& end,
                                           double reach, double& start_gap) {
  const Double3 direction = {gap.x, gap.y, gap.z};
  start_gap = gap_along(kind, direction, start);
  return start_gap > reach && gap_along(kind, direction, end) > reach;
}

/// Of the path of all vertices: before, the pair cannot be near. Both of its simplices may come as
/// far as any vertex does.
PLIANT_HOST_DEVICE inline double wake_after(double path, double distance, double reach) {
  return path + 0.5 * (distance - reach);
}

/// Whether they come nearer than `reach`, and where. Sets `wake`, and `gap` where they do not.
PLIANT_HOST_DEVICE inline bool comes_near(SimplexPair kind, const PairPlaces& start,
                                          const PairPlaces& end, double reach, double path,
                                          SheetGap& gap, double& wake, PairApproach& approach) {
  approach = {0.0, 0.0, {{0.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}};
  const bool stays = stays_apart(kind, gap, start, end, reach, approach.start);
  const bool is_near = !stays && find_approach(kind, start, end, reach, approach);
  wake = wake_after(path, approach.start, reach);
  if (!is_near && !stays) gap = gap_of(approach.between);
  return is_near;
}

/// At the ends of segments their vertices have contacts of their own.
PLIANT_HOST_DEVICE inline bool is_within(const PairWeights& w) {
  for (const double weight : w.of) {
    if (!(std::fabs(weight) > kWithin)) return false;
  }
  return true;
}

/// Whether two triangles have the same point nearest to a vertex.
PLIANT_HOST_DEVICE inline bool is_same_place(const SheetNearPair& a, const SheetNearPair& b) {
  return norm(a.approach.between - b.approach.between) <= kSamePlace * b.thickness;
}

/// Whether a pair that was found near would pass on its path from `start` to `end`, and at which
/// part of it.
PLIANT_HOST_DEVICE inline bool passes(const SheetNearPair& near, const PairPlaces& start,
                                      const PairPlaces& end, double& time) {
  const double distance = near.approach.start;
  if (distance <= kTouching * near.thickness) return false;
  const bool is_tight = distance < kTight * near.thickness;
  const double kept =
      is_tight ? kKeptOfTight * distance : lesser(kKept * near.thickness, kKeptOfStart * distance);
  const Double3 along = stable_normalized(near.approach.between);
  if (gap_along(near.kind, along, start) >= kept && gap_along(near.kind, along, end) >= kept) {
    return false;
  }
  time = 0.0;
  if (is_tight) return true;
  PairApproach approach = {0.0, 0.0, {{0.0, 0.0, 0.0, 0.0}}, {0.0, 0.0, 0.0}};
  const bool comes_near = find_approach(near.kind, start, end, kept, approach);
  time = approach.time;
  return comes_near;
}

}  // namespace sheet_pairs
}  // namespace pliant
