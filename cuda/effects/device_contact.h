#pragma once

#include "cuda/geometry/device_sweep.h"
#include "cuda/solvers/step_state.h"

/// Contacts of particles with obstacles that stand still, as ContactDetection
/// (src/pliant/effects/contact/contact_detection.h) finds them, in single precision.
namespace pliant {

/// Coordinates of an obstacle are measured from the body's centre.
struct DeviceObstacle {
  DeviceShape shape;
  Float3 axes[3];   ///< of the shape, in world
  Float3 position;  ///< of its origin [m]
  float friction;   ///< Coulomb's coefficient

  PLIANT_HOST_DEVICE Float3 inside(Float3 world) const {
    const Float3 p = world - position;
    return {dot(axes[0], p), dot(axes[1], p), dot(axes[2], p)};
  }
  PLIANT_HOST_DEVICE Float3 turned(Float3 local) const {
    return local.x * axes[0] + local.y * axes[1] + local.z * axes[2];
  }
};

struct ContactRules {
  float offset;             ///< that points keep from surfaces [m]
  float margin;             ///< contacts open by less count [m]
  float push_out;           ///< farthest that a point that began too deep is moved in a step [m]
  float safe_displacement;  ///< shorter ones need no swept test [m]
};

/// Where `gap` is how far the point at the prediction is above the tangent plane.
struct FoundContact {
  bool is_there;
  Float3 normal;
  float gap;  ///< [m]
};

/// Contact of a particle that moves from `from` to `to` in a step.
PLIANT_HOST_DEVICE inline FoundContact find_contact(const DeviceObstacle& obstacle,
                                                    const ContactRules& rules, Float3 from,
                                                    Float3 to) {
  const Float3 begin = obstacle.inside(from), end = obstacle.inside(to);
  const Float3 displacement = end - begin;
  const DeviceSurfacePoint last = query(obstacle.shape, end);
  const auto slowly = [&](Float3 normal, float gap) {
    const float least = dot(normal, displacement) - rules.push_out;
    return FoundContact{true, obstacle.turned(normal), gap > least ? gap : least};
  };
  if (norm(displacement) > rules.safe_displacement || last.distance <= 0.0f) {
    const DeviceHit hit = sweep(obstacle.shape, begin, end, rules.offset);
    if (hit.is_hit && !hit.began_inside) {
      return {true, obstacle.turned(hit.normal), dot(hit.normal, end - hit.point)};
    }
    if (hit.is_hit) {
      const DeviceSurfacePoint first = query(obstacle.shape, begin);
      return slowly(first.normal, dot(first.normal, displacement) + first.distance - rules.offset);
    }
  }
  if (last.distance < rules.offset + rules.margin) {
    return slowly(last.normal, last.distance - rules.offset);
  }
  return {false, {0.0f, 0.0f, 0.0f}, 0.0f};
}

}  // namespace pliant
