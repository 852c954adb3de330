#pragma once

#include "cuda/geometry/device_grid.h"

/// Signed distances of shapes in single precision, in the shape's frame.
namespace pliant {

struct DeviceShape {
  enum Kind : int { kPlane, kSphere, kBox, kCapsule, kCylinder, kGrid };
  int kind = kPlane;
  Float3 size = {0.0f, 0.0f, 0.0f};  ///< half extents; of round shapes radius and half length [m]
  DeviceGrid grid = {};

  PLIANT_HOST_DEVICE bool is_convex() const { return kind != kGrid; }
};

PLIANT_HOST_DEVICE inline DeviceSurfacePoint query(const DeviceShape& shape, Float3 p) {
  switch (shape.kind) {
    case DeviceShape::kSphere:
      return distance_to_sphere(p, shape.size.x);
    case DeviceShape::kBox:
      return distance_to_box(p, shape.size);
    case DeviceShape::kCapsule:
      return distance_to_capsule(p, shape.size.x, shape.size.y);
    case DeviceShape::kCylinder:
      return distance_to_cylinder(p, shape.size.x, shape.size.y);
    case DeviceShape::kGrid:
      return query(shape.grid, p);
    default:
      return distance_to_plane(p);
  }
}

}  // namespace pliant
