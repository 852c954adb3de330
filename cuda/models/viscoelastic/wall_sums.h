#pragma once

#include "cuda/models/viscoelastic/liquid_sums.h"

/// Half spaces as a liquid feels them (LiquidWalls), in single precision. Lengths over H.
namespace pliant {

constexpr int kMostWalls = 8;

struct HalfSpaces {
  int count = 0;
  Float4 planes[kMostWalls];  ///< normal, and what n·x is on it [m], from the body's centre
};

namespace wall_detail {

// As in LiquidWalls.
constexpr float kGain = 7.63f;
constexpr float kSetBack = 0.2813f;
constexpr float kMostFilled = 0.98f;
constexpr float kNearestDrag = 0.125f;

PLIANT_HOST_DEVICE inline float left_of(float s) { return s < 1.0f ? 1.0f - s : 0.0f; }
/// Distance over H.
PLIANT_HOST_DEVICE inline float distance_to(const Float4& plane, Float3 x, float support) {
  return (dot(plane.xyz(), x) - plane.w) / support;
}
PLIANT_HOST_DEVICE inline float filled_at(float s) {
  const float u = left_of(s + kSetBack), u2 = u * u;
  const float filled = kGain * 30.0f * u2 * u2 * u * (0.05f - u / 30.0f);
  return filled < kMostFilled ? filled : kMostFilled;
}
PLIANT_HOST_DEVICE inline float push_at(float s) {
  const float u = left_of(s + kSetBack), u2 = u * u;
  return kGain * 30.0f * u2 * u2 * (0.25f - 0.2f * u);
}
PLIANT_HOST_DEVICE inline float drag_at(float s) {
  const float near = s > kNearestDrag ? s : kNearestDrag, u = left_of(near);
  return 90.0f * u * u * u * (1.0f / 6.0f + u * (u / 15.0f - 5.0f / 24.0f)) / near;
}

}  // namespace wall_detail

/// What walls fill about each particle.
struct FillWalls {
  HalfSpaces walls;
  const Fixed* x;  ///< by particle, and V/H³
  float quantum, support;
  float* filled;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    const Float3 at = quantum * (x[i] - Fixed{0, 0, 0, 0.0f});
    float open = 1.0f;
    for (int k = 0; k < walls.count; ++k) {
      const float s = wall_detail::distance_to(walls.planes[k], at, support);
      if (s < 1.0f) open *= 1.0f - wall_detail::filled_at(s);
    }
    filled[i] = 1.0f - open;
  }
};

/// Adds their forces, from the densities that they helped to make.
struct PushWalls {
  HalfSpaces walls;
  const Fixed* x;
  const Float4* motion;
  const int* parts;  ///< null: there is one
  const LiquidConstants* constants;
  const float *filled, *filling;
  float quantum, support;
  Float4* forces;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (motion[i].w == 0.0f) return;
    const Float3 at = quantum * (x[i] - Fixed{0, 0, 0, 0.0f});
    const LiquidConstants c = constants[parts == nullptr ? 0 : parts[i]];
    const float psi = filling[i], h2 = support * support;
    const float pressure =
        psi > 1.0f ? c.bulk * (psi - 1.0f) / (psi * psi) / static_cast<float>(kSphSlope) : 0.0f;
    Float3 force = {0.0f, 0.0f, 0.0f};
    for (int k = 0; k < walls.count; ++k) {
      const Float3 normal = walls.planes[k].xyz();
      const float s = wall_detail::distance_to(walls.planes[k], at, support);
      if (s >= 1.0f) continue;
      const float others = (1.0f - filled[i]) / (1.0f - wall_detail::filled_at(s));
      const Float3 v = motion[i].xyz();
      force += (others * pressure * h2 * wall_detail::push_at(s)) * normal;
      force -=
          (c.viscosity / static_cast<float>(kSphLaplacian) * support * wall_detail::drag_at(s)) *
          (v - dot(normal, v) * normal);
    }
    const Float3 sum = forces[i].xyz() + (motion[i].w * x[i].w) * force;
    forces[i] = with_w(sum, 0.0f);
  }
};

}  // namespace pliant
