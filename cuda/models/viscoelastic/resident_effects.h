#pragma once

#include "cuda/core/vector.h"

/// What effects of liquids make of their sums (effect_sums.h) in a resident run.
namespace pliant {

struct AddScaled {
  const Float4* sums;
  float factor;
  Float4* to;

  PLIANT_HOST_DEVICE void operator()(int i) const {
    to[i] = with_w(to[i].xyz() + factor * sums[i].xyz(), 0.0f);
  }
};

/// XSPH: velocities change by impulses.
struct MixVelocities {
  const Float4* sums;
  const float* mobility;  ///< 0 for what is fixed
  const Fixed* now;       ///< with M/h²
  float factor;
  Float4* velocity;  ///< as ResidentArrays has it

  PLIANT_HOST_DEVICE void operator()(int i) const {
    if (mobility[i] == 0.0f) return;
    velocity[i] = with_w(velocity[i].xyz() + (factor / now[i].w) * sums[i].xyz(), 0.0f);
  }
};

}  // namespace pliant
