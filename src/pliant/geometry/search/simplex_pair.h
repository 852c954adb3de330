#pragma once

#include "pliant/math/vector3.h"

/// Where two simplices of four points together are nearest, and where they come near on their
/// paths: one source for CPU and GPU. With Eigen: nearest_pair.h.
namespace pliant {

/// The first point and the triangle of the others, or the segment of the first two and that of the
/// last two.
enum class SimplexPair { kPointTriangle, kSegments };

/// Places of the four points [m].
struct PairPlaces {
  Double3 at[4];
};

/// Weights w of the four points whose sum leads from the nearest point of the second simplex to
/// that of the first. Of each simplex their sizes sum to 1.
struct PairWeights {
  double of[4];
};

/// Where two simplices come near.
struct PairApproach {
  double time;          ///< in [0, 1]
  double start;         ///< distance at time 0 [m]; also where they do not come near
  PairWeights weights;  ///< of the nearest points at that time
  Double3 between;      ///< from the second's to the first's at that time [m]
};

/// How many of the points are the first simplex's.
PLIANT_HOST_DEVICE inline int first_of(SimplexPair kind) {
  return kind == SimplexPair::kSegments ? 2 : 1;
}

PLIANT_HOST_DEVICE inline Double3 offset_between(const PairPlaces& x, const PairWeights& w) {
  const auto along = [&](double a, double b, double c, double d) {
    return ((w.of[0] * a + w.of[1] * b) + w.of[2] * c) + w.of[3] * d;
  };
  return {along(x.at[0].x, x.at[1].x, x.at[2].x, x.at[3].x),
          along(x.at[0].y, x.at[1].y, x.at[2].y, x.at[3].y),
          along(x.at[0].z, x.at[1].z, x.at[2].z, x.at[3].z)};
}

namespace simplex_pair_detail {

// Steps of an advancement; a pair for which it does not end is taken as a near pair.
constexpr int kMaxAdvances = 64;
// Of the reach: advancing to it alone would never arrive.
constexpr double kAimed = 0.9;
// Weights of a point on a triangle are not smaller but by round-off, unless it has no area.
constexpr double kOutside = 1e-6;

PLIANT_HOST_DEVICE inline bool is_number(double value) { return value - value == 0.0; }

PLIANT_HOST_DEVICE inline Double3 closest_on_segment(const Double3& p, const Double3& a,
                                                     const Double3& b) {
  const Double3 side = b - a;
  const double squared = squared_norm(side);
  if (squared == 0.0) return a;
  return a + clamped(dot(side, p - a) / squared, 0.0, 1.0) * side;
}

/// Shares s, t of two segments p + s d, q + t e at which they are nearest (Ericson 2005, Real-Time
/// Collision Detection, 5.1.9).
PLIANT_HOST_DEVICE inline void nearest_shares(const Double3& p, const Double3& d, const Double3& q,
                                              const Double3& e, double& s, double& t) {
  const Double3 r = p - q;
  const double dd = squared_norm(d), ee = squared_norm(e), er = dot(e, r), dr = dot(d, r);
  if (!(dd > 0.0)) {
    s = 0.0;
    t = ee > 0.0 ? clamped(er / ee, 0.0, 1.0) : 0.0;
    return;
  }
  if (!(ee > 0.0)) {
    s = clamped(-dr / dd, 0.0, 1.0);
    t = 0.0;
    return;
  }
  const double de = dot(d, e), across = dd * ee - de * de;
  // Parallel: any s will do.
  s = across > 1e-14 * dd * ee ? clamped((de * er - dr * ee) / across, 0.0, 1.0) : 0.5;
  t = (de * s + er) / ee;
  if (t < 0.0 || t > 1.0) {
    t = clamped(t, 0.0, 1.0);
    s = clamped((de * t - dr) / dd, 0.0, 1.0);
  }
}

}  // namespace simplex_pair_detail

/// The point of the triangle a, b, c nearest to p; of triangles without area too.
PLIANT_HOST_DEVICE inline Double3 closest_on_triangle(const Double3& p, const Double3& a,
                                                      const Double3& b, const Double3& c) {
  using simplex_pair_detail::closest_on_segment;
  const Double3 normal = cross(b - a, c - a);
  const double squared = squared_norm(normal);
  // Barycentric coordinates of p's projection, times squared.
  const double at_a = dot(cross(c - b, p - b), normal);
  const double at_b = dot(cross(a - c, p - c), normal);
  const double at_c = dot(cross(b - a, p - a), normal);
  if (squared > 0.0 && at_a >= 0.0 && at_b >= 0.0 && at_c >= 0.0) {
    return p - (dot(normal, p - a) / squared) * normal;
  }
  const Double3 sides[3] = {closest_on_segment(p, a, b), closest_on_segment(p, b, c),
                            closest_on_segment(p, c, a)};
  int best = 0;
  for (int k = 1; k < 3; ++k) {
    if (squared_norm(sides[k] - p) < squared_norm(sides[best] - p)) best = k;
  }
  return sides[best];
}

/// Barycentric coordinates of a place on a triangle; not finite on one without area.
PLIANT_HOST_DEVICE inline Double3 triangle_weights(const Double3& first, const Double3& second,
                                                   const Double3& third, const Double3& at) {
  const Double3 a = second - first, b = third - first, p = at - first;
  const double aa = squared_norm(a), ab = dot(a, b), bb = squared_norm(b);
  const double det = aa * bb - ab * ab;
  const double v = (bb * dot(p, a) - ab * dot(p, b)) / det;
  const double w = (aa * dot(p, b) - ab * dot(p, a)) / det;
  return {1.0 - v - w, v, w};
}

namespace simplex_pair_detail {

/// Weights of a triangle's corners for its point nearest to p.
PLIANT_HOST_DEVICE inline Double3 nearest_on_triangle(const Double3& p, const Double3* corners) {
  const Double3 on = closest_on_triangle(p, corners[0], corners[1], corners[2]);
  const Double3 weights = triangle_weights(corners[0], corners[1], corners[2], on);
  if (is_number(weights.x) && is_number(weights.y) && is_number(weights.z) &&
      lesser(lesser(weights.x, weights.y), weights.z) >= -kOutside) {
    return weights;
  }
  // Without area it is its sides.
  double best[3] = {1.0, 0.0, 0.0};
  double least = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Double3 side = corners[next] - corners[k];
    double none = 0.0, t = 0.0;
    nearest_shares(p, {0.0, 0.0, 0.0}, corners[k], side, none, t);
    const double distance = norm(corners[k] + t * side - p);
    if (!(distance < least)) continue;
    least = distance;
    best[0] = best[1] = best[2] = 0.0;
    best[k] = 1.0 - t;
    best[next] = t;
  }
  return {best[0], best[1], best[2]};
}

/// The fastest that any two points of the two simplices come together.
PLIANT_HOST_DEVICE inline double fastest(SimplexPair kind, const PairPlaces& motion) {
  double squared = 0.0;
  for (int a = 0; a < 2; ++a) {
    for (int b = 1; b < 4; ++b) {
      if (a >= first_of(kind) || b < first_of(kind)) continue;
      squared = greater(squared, squared_norm(motion.at[a] - motion.at[b]));
    }
  }
  return std::sqrt(squared);
}

}  // namespace simplex_pair_detail

/// For degenerate simplices too; where several points are nearest any one of them.
PLIANT_HOST_DEVICE inline PairWeights nearest_weights(SimplexPair kind, const PairPlaces& x) {
  using namespace simplex_pair_detail;
  if (kind == SimplexPair::kPointTriangle) {
    const Double3 w = nearest_on_triangle(x.at[0], x.at + 1);
    return {{1.0, -w.x, -w.y, -w.z}};
  }
  double s = 0.0, t = 0.0;
  nearest_shares(x.at[0], x.at[1] - x.at[0], x.at[2], x.at[3] - x.at[2], s, t);
  return {{1.0 - s, s, t - 1.0, -t}};
}

/// Whether simplices whose points move straight from `start` to `end` come nearer than `reach` > 0
/// [m], and about where first: conservative advancement, which steps no farther than the points'
/// speeds allow (Mirtich 1996). What comes not nearer than 0.9 `reach` may go unnoticed; what is
/// not finite never meets, and leaves `found` as it is where that shows at the start.
PLIANT_HOST_DEVICE inline bool find_approach(SimplexPair kind, const PairPlaces& start,
                                             const PairPlaces& end, double reach,
                                             PairApproach& found) {
  using namespace simplex_pair_detail;
  PairPlaces motion;
  for (int k = 0; k < 4; ++k) motion.at[k] = end.at[k] - start.at[k];
  const double speed = fastest(kind, motion);
  double time = 0.0;
  for (int k = 0; k < kMaxAdvances; ++k) {
    PairPlaces x;
    for (int p = 0; p < 4; ++p) x.at[p] = start.at[p] + time * motion.at[p];
    const PairWeights weights = nearest_weights(kind, x);
    const Double3 between = offset_between(x, weights);
    const double distance = norm(between);
    if (!is_number(distance)) return false;
    found = {time, k == 0 ? distance : found.start, weights, between};
    if (distance <= reach) return true;
    if (!(distance - kAimed * reach <= (1.0 - time) * speed)) return false;
    time += (distance - kAimed * reach) / speed;
  }
  return true;
}

}  // namespace pliant
