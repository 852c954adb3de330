#pragma once

#include "cuda/geometry/device_shape.h"

/// When a point on its path first comes within an offset of a shape, as sweep_point()
/// (src/pliant/geometry/search/sweep.h) finds it, to the precision of single numbers.
namespace pliant {

struct DeviceHit {
  bool is_hit;
  bool began_inside;
  Float3 point, normal;
};

namespace device_sweep_detail {

struct Path {
  Float3 from, along;               ///< along: of unit length
  float length, offset, tolerance;  // [m]

  PLIANT_HOST_DEVICE Float3 at(float s) const { return from + s * along; }
};

// The distance to a convex shape is convex along a line, so its tangent lies below it: Newton's
// method never oversteps, and a point that does not approach never will.
PLIANT_HOST_DEVICE inline DeviceHit convex(const DeviceShape& shape, const Path& path, Float3 to,
                                           DeviceSurfacePoint near) {
  constexpr int kMaxIterations = 40;
  float s = 0.0f;
  for (int i = 0; i < kMaxIterations; ++i) {
    if (i > 0) near = query(shape, path.at(s));
    const float gap = near.distance - path.offset, approach = -dot(near.normal, path.along);
    if (approach <= 0.0f && gap > 0.0f) return {false, false, to, near.normal};
    if (gap <= path.tolerance) break;
    s += gap / approach;
    if (s > path.length) return {false, false, to, near.normal};
  }
  return {true, false, path.at(s), near.normal};
}

/// The part of the path within the bounds, widened by the offset; false where there is none.
PLIANT_HOST_DEVICE inline bool clip(const DeviceGrid& grid, const Path& path, float& begin,
                                    float& end) {
  const float margin = path.offset + path.tolerance;
  for (int k = 0; k < 3; ++k) {
    const float low = (&grid.low.x)[k] - margin - (&path.from.x)[k];
    const float high = (&grid.high.x)[k] + margin - (&path.from.x)[k];
    const float along = (&path.along.x)[k];
    if (along == 0.0f) {
      if (low > 0.0f || high < 0.0f) return false;
      continue;
    }
    const float a = low / along, b = high / along;
    begin = fmaxf(begin, fminf(a, b));
    end = fminf(end, fmaxf(a, b));
  }
  return begin <= end;
}

/// Where the gap, positive at `free` and negative at `inside`, vanishes; on the free side.
PLIANT_HOST_DEVICE inline float first_contact(const DeviceShape& shape, const Path& path,
                                              float free, float inside) {
  while (inside - free > path.tolerance) {
    const float middle = 0.5f * (free + inside);
    if (middle <= free || middle >= inside) break;
    (query(shape, path.at(middle)).distance > path.offset ? free : inside) = middle;
  }
  return free;
}

// Sphere tracing. Steps never get smaller than `least` while the point only slides along the
// surface, or grazing would take forever.
PLIANT_HOST_DEVICE inline DeviceHit general(const DeviceShape& shape, const Path& path, Float3 to) {
  constexpr int kMaxIterations = 1000;
  constexpr float kSlides = 0.1f;  // sine of the angle between path and surface
  const DeviceHit none = {false, false, to, {0.0f, 0.0f, 1.0f}};
  const auto hit_at = [&](float s) {
    const Float3 point = path.at(s);
    return DeviceHit{true, false, point, query(shape, point).normal};
  };
  float s = 0.0f, end = path.length;
  if (!clip(shape.grid, path, s, end)) return none;
  const float least = (end - s) / 256.0f;
  float free = s;
  for (int i = 0; i < kMaxIterations; ++i) {
    const DeviceSurfacePoint near = query(shape, path.at(s));
    const float gap = near.distance - path.offset;
    if (gap <= 0.0f) return hit_at(first_contact(shape, path, free, s));
    const float approach = -dot(near.normal, path.along);
    if (gap <= path.tolerance && approach > 0.0f) return hit_at(s);
    if (s >= end) return none;
    free = s;
    s = fminf(end, s + (approach > kSlides ? fmaxf(gap, path.tolerance) : fmaxf(gap, least)));
  }
  return hit_at(free);
}

}  // namespace device_sweep_detail

PLIANT_HOST_DEVICE inline DeviceHit sweep(const DeviceShape& shape, Float3 from, Float3 to,
                                          float offset) {
  constexpr float kRoundOff = 1e-6f;
  const Float3 displacement = to - from;
  const float length = norm(displacement);
  const DeviceSurfacePoint near = query(shape, from);
  if (near.distance <= offset) return {true, true, from, near.normal};
  if (length == 0.0f || near.distance - offset > length) return {false, false, to, near.normal};
  const device_sweep_detail::Path path = {from, (1.0f / length) * displacement, length, offset,
                                          kRoundOff * (length + norm(from) + offset)};
  return shape.is_convex() ? device_sweep_detail::convex(shape, path, to, near)
                           : device_sweep_detail::general(shape, path, to);
}

}  // namespace pliant
