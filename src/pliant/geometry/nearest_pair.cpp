#include "pliant/geometry/nearest_pair.h"

#include <algorithm>
#include <cmath>

#include "pliant/geometry/barycentric.h"
#include "pliant/geometry/closest_point.h"

namespace pliant {
namespace {

// Steps of an advancement; one that does not end is taken as a meeting.
constexpr int kMaxAdvances = 64;
// Of the reach: advancing to it alone would never arrive.
constexpr double kAimed = 0.9;

// Weights of a point on a triangle are not smaller but by round-off, unless it has no area.
constexpr double kOutside = 1e-6;

double clamped(double value) { return std::clamp(value, 0.0, 1.0); }

/// Shares s, t of two segments p + s d, q + t e at which they are nearest (Ericson 2005, Real-Time
/// Collision Detection, 5.1.9).
Eigen::Vector2d nearest_shares(const Eigen::Vector3d& p, const Eigen::Vector3d& d,
                               const Eigen::Vector3d& q, const Eigen::Vector3d& e) {
  const Eigen::Vector3d r = p - q;
  const double dd = d.squaredNorm(), ee = e.squaredNorm(), er = e.dot(r), dr = d.dot(r);
  if (!(dd > 0.0)) return {0.0, ee > 0.0 ? clamped(er / ee) : 0.0};
  if (!(ee > 0.0)) return {clamped(-dr / dd), 0.0};
  const double de = d.dot(e), across = dd * ee - de * de;
  // Parallel: any s will do.
  double s = across > 1e-14 * dd * ee ? clamped((de * er - dr * ee) / across) : 0.5;
  double t = (de * s + er) / ee;
  if (t < 0.0 || t > 1.0) {
    t = clamped(t);
    s = clamped((de * t - dr) / dd);
  }
  return {s, t};
}

/// Weights of a triangle's corners for its point nearest to p.
Eigen::Vector3d nearest_on_triangle(const Eigen::Vector3d& p, const Eigen::Matrix3d& corners) {
  const Eigen::Vector3d on =
      closest_point_on_triangle(p, corners.col(0), corners.col(1), corners.col(2));
  const Eigen::Vector3d weights = triangle_weights(corners, on);
  if (weights.allFinite() && weights.minCoeff() >= -kOutside) return weights;
  // Without area it is its sides.
  Eigen::Vector3d best = Eigen::Vector3d::UnitX();
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Eigen::Vector3d side = corners.col(next) - corners.col(k);
    const double t = nearest_shares(p, Eigen::Vector3d::Zero(), corners.col(k), side)[1];
    const double distance = (corners.col(k) + t * side - p).norm();
    if (!(distance < least)) continue;
    least = distance;
    best.setZero();
    best[k] = 1.0 - t;
    best[next] = t;
  }
  return best;
}

/// The fastest that any two points of the two simplices come together.
double fastest(SimplexPair kind, const FourPoints& motion) {
  const int first = kind == SimplexPair::kPointTriangle ? 1 : 2;
  double squared = 0.0;
  for (int a = 0; a < first; ++a) {
    for (int b = first; b < 4; ++b) {
      squared = std::max(squared, (motion.col(a) - motion.col(b)).squaredNorm());
    }
  }
  return std::sqrt(squared);
}

}  // namespace

Eigen::Vector4d nearest_pair(SimplexPair kind, const FourPoints& x) {
  Eigen::Vector4d weights;
  if (kind == SimplexPair::kPointTriangle) {
    weights << 1.0, -nearest_on_triangle(x.col(0), x.rightCols<3>());
  } else {
    const Eigen::Vector2d at =
        nearest_shares(x.col(0), x.col(1) - x.col(0), x.col(2), x.col(3) - x.col(2));
    weights << 1.0 - at[0], at[0], at[1] - 1.0, -at[1];
  }
  return weights;
}

bool find_approach(SimplexPair kind, const FourPoints& start, const FourPoints& end, double reach,
                   Approach& found) {
  const FourPoints motion = end - start;
  const double speed = fastest(kind, motion);
  double time = 0.0;
  for (int k = 0; k < kMaxAdvances; ++k) {
    const FourPoints x = start + time * motion;
    const Eigen::Vector4d weights = nearest_pair(kind, x);
    const Eigen::Vector3d way = x * weights;
    const double distance = way.norm();
    if (!std::isfinite(distance)) return false;
    found = {time, k == 0 ? distance : found.start, weights, way};
    if (distance <= reach) return true;
    if (!(distance - kAimed * reach <= (1.0 - time) * speed)) return false;
    time += (distance - kAimed * reach) / speed;
  }
  return true;
}

}  // namespace pliant
