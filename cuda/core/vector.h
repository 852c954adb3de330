#pragma once

#include <cmath>

#include "pliant/math/host_device.h"
#include "pliant/math/vector3.h"

namespace pliant {

/// One load or store of 16 bytes.
struct alignas(16) Float4 {
  float x, y, z, w;

  PLIANT_HOST_DEVICE Float3 xyz() const { return {x, y, z}; }
};

struct alignas(8) Float2 {
  float x, y;
};

struct alignas(16) Int4 {
  int v[4];
};

struct alignas(8) UShort4 {
  unsigned short v[4];
};

/// A position in whole quanta from the body's centre. Differences of positions are exact, so that
/// strains keep all digits of single precision however fine the mesh is: with positions in single
/// precision, short edges would be differences of long numbers.
struct alignas(16) Fixed {
  int x, y, z;
  float w;  ///< for use beside a position
};

/// In quanta.
PLIANT_HOST_DEVICE inline Float3 operator-(const Fixed& a, const Fixed& b) {
  return {static_cast<float>(a.x - b.x), static_cast<float>(a.y - b.y),
          static_cast<float>(a.z - b.z)};
}

PLIANT_HOST_DEVICE inline int nearest_int(float value) {
#ifdef __CUDA_ARCH__
  return __float2int_rn(value);
#else
  constexpr float kLargest = 1073741824.0f;
  if (!(value > -kLargest)) return -1073741824;
  return value < kLargest ? static_cast<int>(nearbyintf(value)) : 1073741824;
#endif
}

/// What other blocks of the same launch may have written: past the caches that they do not share.
PLIANT_HOST_DEVICE inline Fixed load_fresh(const Fixed* from) {
#ifdef __CUDA_ARCH__
  const int4 bits = __ldcg(reinterpret_cast<const int4*>(from));
  return {bits.x, bits.y, bits.z, __int_as_float(bits.w)};
#else
  return *from;
#endif
}

/// `displacement` in quanta.
PLIANT_HOST_DEVICE inline Fixed moved(const Fixed& from, const Float3& displacement) {
  return {from.x + nearest_int(displacement.x), from.y + nearest_int(displacement.y),
          from.z + nearest_int(displacement.z), from.w};
}

PLIANT_HOST_DEVICE inline Float4 with_w(Float3 a, float w) { return {a.x, a.y, a.z, w}; }

}  // namespace pliant
