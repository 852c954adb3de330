#pragma once

#include "cuda/core/vector.h"
#include "pliant/math/matrix3.h"

namespace pliant {

/// Where a search for a rotation begins: a unit quaternion to 15 bits; zero: nobody knows.
struct alignas(8) PackedRotation {
  short v[4];
};

PLIANT_HOST_DEVICE inline PackedRotation packed(const Quaternion<float>& q) {
  constexpr float kOne = 32767.0f;
  const float numbers[4] = {q.w, q.x, q.y, q.z};
  PackedRotation result;
  for (int k = 0; k < 4; ++k) {
    result.v[k] = static_cast<short>(nearest_int(kOne * numbers[k]));
  }
  return result;
}

PLIANT_HOST_DEVICE inline bool is_unknown(const PackedRotation& packed) {
  return (packed.v[0] | packed.v[1] | packed.v[2] | packed.v[3]) == 0;
}

/// Of unit length to 15 bits, which a search does not mind; zero where nobody knows.
PLIANT_HOST_DEVICE inline Quaternion<float> unpacked(const PackedRotation& packed) {
  constexpr float kUnit = 1.0f / 32767.0f;
  const Quaternion<float> q = {static_cast<float>(packed.v[0]), static_cast<float>(packed.v[1]),
                               static_cast<float>(packed.v[2]), static_cast<float>(packed.v[3])};
  return kUnit * q;
}

}  // namespace pliant
