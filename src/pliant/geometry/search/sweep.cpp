#include "pliant/geometry/search/sweep.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

using Eigen::Vector3d;

struct Path {
  const Shape& shape;
  Vector3d from;
  Vector3d to;
  double offset;
  double length;     // [m]
  Vector3d along;    // unit
  double tolerance;  // [m]

  Vector3d at(double s) const { return from + s * along; }
};

SweepHit no_hit(const Vector3d& to) { return {false, 1.0, to, Vector3d::UnitZ()}; }

SweepHit hit_at(const Path& path, double s) {
  const double time = std::clamp(s / path.length, 0.0, 1.0);
  const Vector3d point = path.from + time * (path.to - path.from);
  return {true, time, point, path.shape.query(point).normal};
}

// The distance to a convex shape is convex along a line, so its tangent lies below it: Newton's
// method never oversteps, and a point that does not approach never will. A hundred halvings of the
// path are more than doubles can hold.
SweepHit sweep_convex(const Path& path) {
  constexpr int kMaxIterations = 100;
  double s = 0.0;
  for (int i = 0; i < kMaxIterations; ++i) {
    const SurfacePoint near = path.shape.query(path.at(s));
    const double gap = near.distance - path.offset;
    const double approach = -near.normal.dot(path.along);
    if (approach <= 0.0 && gap > 0.0) return no_hit(path.to);
    if (gap <= path.tolerance) break;
    s += gap / approach;
    if (s > path.length) return no_hit(path.to);
  }
  return hit_at(path, s);
}

// The parts of the path before and after the bounds (widened by the offset) are free.
bool clip(const Path& path, double& begin, double& end) {
  const Eigen::AlignedBox3d box = path.shape.bounds();
  const double margin = path.offset + path.tolerance;
  for (int k = 0; k < 3; ++k) {
    const double low = box.min()[k] - margin - path.from[k];
    const double high = box.max()[k] + margin - path.from[k];
    if (path.along[k] == 0.0) {
      if (low > 0.0 || high < 0.0) return false;
      continue;
    }
    const double a = low / path.along[k];
    const double b = high / path.along[k];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin <= end;
}

// Where the gap, positive at `free` and negative at `inside`, vanishes; on the free side.
double first_contact(const Path& path, double free, double inside) {
  while (inside - free > path.tolerance) {
    const double middle = 0.5 * (free + inside);
    if (middle <= free || middle >= inside) break;
    const double gap = path.shape.distance(path.at(middle)) - path.offset;
    (gap > 0.0 ? free : inside) = middle;
  }
  return free;
}

// Sphere tracing. Steps never get smaller than `least` while the point only slides along the
// surface, or grazing would take forever.
SweepHit sweep_general(const Path& path) {
  constexpr int kMaxIterations = 2000;
  constexpr double kSlides = 0.1;  // sine of the angle between path and surface
  double s = 0.0;
  double end = path.length;
  if (!clip(path, s, end)) return no_hit(path.to);
  const double least = (end - s) / 256.0;
  double free = s;
  for (int i = 0; i < kMaxIterations; ++i) {
    const SurfacePoint near = path.shape.query(path.at(s));
    const double gap = near.distance - path.offset;
    if (gap <= 0.0) return hit_at(path, first_contact(path, free, s));
    const double approach = -near.normal.dot(path.along);
    if (gap <= path.tolerance && approach > 0.0) return hit_at(path, s);
    if (s >= end) return no_hit(path.to);
    free = s;
    s = std::min(end, s + (approach > kSlides ? gap : std::max(gap, least)));
  }
  return hit_at(path, free);
}

}  // namespace

SweepHit sweep_point(const Shape& shape, const Vector3d& from, const Vector3d& to, double offset) {
  const Vector3d displacement = to - from;
  const double length = displacement.norm();
  if (!std::isfinite(length) || !from.allFinite() || !std::isfinite(offset)) return no_hit(to);
  const double gap = shape.distance(from) - offset;
  if (gap > length) return no_hit(to);
  if (gap <= 0.0) return {true, 0.0, from, shape.query(from).normal};
  const double tolerance = 1e-9 * length + 1e-15 * (from.norm() + std::abs(offset));
  const Path path{shape, from, to, offset, length, displacement / length, tolerance};
  return shape.convex() ? sweep_convex(path) : sweep_general(path);
}

}  // namespace pliant
