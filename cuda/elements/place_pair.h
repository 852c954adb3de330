#pragma once

#include <cstring>

#include "pliant/math/host_device.h"

namespace pliant {

/// Two numbers of places within a block, in the bits of a float: rows of entries have no other room
/// for them. They are copied, never computed with.
struct PlacePair {
  unsigned short first, second;
};

PLIANT_HOST_DEVICE inline float bits_of(const PlacePair& pair) {
  const unsigned int both =
      static_cast<unsigned int>(pair.first) | static_cast<unsigned int>(pair.second) << 16;
#ifdef __CUDA_ARCH__
  return __uint_as_float(both);
#else
  float bits;
  std::memcpy(&bits, &both, sizeof(bits));
  return bits;
#endif
}

PLIANT_HOST_DEVICE inline PlacePair pair_of(float bits) {
#ifdef __CUDA_ARCH__
  const unsigned int both = __float_as_uint(bits);
#else
  unsigned int both;
  std::memcpy(&both, &bits, sizeof(both));
#endif
  return {static_cast<unsigned short>(both & 0xffffu), static_cast<unsigned short>(both >> 16)};
}

}  // namespace pliant
