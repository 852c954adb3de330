#pragma once

#include "cuda/geometry/device_grid.h"

/// Signed distances of shapes in single precision, for CPU and GPU from one source. Formulas and
/// ties are those of src/pliant/geometry/distance/primitive_shapes.cpp, in the shape's frame.
namespace pliant {

struct DeviceShape {
  enum Kind : int { kPlane, kSphere, kBox, kCapsule, kCylinder, kGrid };
  int kind = kPlane;
  Float3 size = {0.0f, 0.0f, 0.0f};  ///< half extents; of round shapes radius and half length [m]
  DeviceGrid grid = {};

  PLIANT_HOST_DEVICE bool is_convex() const { return kind != kGrid; }
};

namespace device_shape_detail {

constexpr float kNoDirection = 1e-18f;

PLIANT_HOST_DEVICE inline float sign(float x) { return x < 0.0f ? -1.0f : 1.0f; }
PLIANT_HOST_DEVICE inline float above(float x, float least) { return x > least ? x : least; }

PLIANT_HOST_DEVICE inline DeviceSurfacePoint round(Float3 from_axis, float radius, Float3 other) {
  const float r = norm(from_axis);
  return {r - radius, r < kNoDirection ? other : (1.0f / r) * from_axis};
}

PLIANT_HOST_DEVICE inline DeviceSurfacePoint box(Float3 p, Float3 half) {
  const Float3 beyond = {fabsf(p.x) - half.x, fabsf(p.y) - half.y, fabsf(p.z) - half.z};
  const Float3 outside = {above(beyond.x, 0.0f), above(beyond.y, 0.0f), above(beyond.z, 0.0f)};
  const float distance = norm(outside);
  if (distance > kNoDirection) {
    const float s = 1.0f / distance;
    return {distance,
            {sign(p.x) * s * outside.x, sign(p.y) * s * outside.y, sign(p.z) * s * outside.z}};
  }
  DeviceSurfacePoint face = {beyond.z, {0.0f, 0.0f, sign(p.z)}};
  if (beyond.y > face.distance) face = {beyond.y, {0.0f, sign(p.y), 0.0f}};
  if (beyond.x > face.distance) face = {beyond.x, {sign(p.x), 0.0f, 0.0f}};
  return face;
}

PLIANT_HOST_DEVICE inline DeviceSurfacePoint cylinder(Float3 p, float radius, float half_length) {
  const float r = sqrtf(p.x * p.x + p.y * p.y);
  const Float3 radial =
      r < kNoDirection ? Float3{1.0f, 0.0f, 0.0f} : Float3{p.x / r, p.y / r, 0.0f};
  const Float3 axial = {0.0f, 0.0f, sign(p.z)};
  const float side = r - radius, end = fabsf(p.z) - half_length;
  if (side > 0.0f && end > 0.0f) {
    const float distance = sqrtf(side * side + end * end);
    if (distance > kNoDirection) {
      return {distance, (1.0f / distance) * (side * radial + end * axial)};
    }
  }
  return end >= side ? DeviceSurfacePoint{end, axial} : DeviceSurfacePoint{side, radial};
}

}  // namespace device_shape_detail

PLIANT_HOST_DEVICE inline DeviceSurfacePoint query(const DeviceShape& shape, Float3 p) {
  using namespace device_shape_detail;
  switch (shape.kind) {
    case DeviceShape::kSphere:
      return round(p, shape.size.x, {0.0f, 0.0f, 1.0f});
    case DeviceShape::kBox:
      return box(p, shape.size);
    case DeviceShape::kCapsule:
      return round({p.x, p.y, sign(p.z) * above(fabsf(p.z) - shape.size.y, 0.0f)}, shape.size.x,
                   {1.0f, 0.0f, 0.0f});
    case DeviceShape::kCylinder:
      return cylinder(p, shape.size.x, shape.size.y);
    case DeviceShape::kGrid:
      return query(shape.grid, p);
    default:
      return {p.z, {0.0f, 0.0f, 1.0f}};
  }
}

}  // namespace pliant
