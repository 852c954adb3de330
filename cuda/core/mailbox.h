#pragma once

#include <cstdlib>
#include <cstring>

#include "cuda/core/vector.h"

/// Mailboxes, by which blocks of one launch that run at the same time exchange numbers: 16 bytes of
/// global memory that are written and read at once, of which the last 4 say which version they are.
/// A block that waits for a version needs no other sign that it is there, and no block waits for
/// those whose numbers it does not read.
namespace pliant {

PLIANT_HOST_DEVICE inline float version_bits(int version) {
#ifdef __CUDA_ARCH__
  return __int_as_float(version);
#else
  float bits;
  std::memcpy(&bits, &version, sizeof bits);
  return bits;
#endif
}

/// Writes `value` into the mailbox `to` as its `version`; w of `value` is lost.
PLIANT_HOST_DEVICE inline void post(Fixed* to, const Fixed& value, int version) {
#ifdef __CUDA_ARCH__
  const unsigned x = static_cast<unsigned>(value.x), y = static_cast<unsigned>(value.y),
                 z = static_cast<unsigned>(value.z), w = static_cast<unsigned>(version);
  asm volatile(
      "{\n\t.reg .b64 low, high;\n\t.reg .b128 all;\n\t"
      "mov.b64 low, {%1, %2};\n\tmov.b64 high, {%3, %4};\n\tmov.b128 all, {low, high};\n\t"
      "st.relaxed.gpu.global.b128 [%0], all;\n\t}" ::"l"(__cvta_generic_to_global(to)),
      "r"(x), "r"(y), "r"(z), "r"(w)
      : "memory");
#else
  *to = {value.x, value.y, value.z, version_bits(version)};
#endif
}

/// Waits until the mailbox `from` holds `version`, and reads it.
PLIANT_HOST_DEVICE inline Fixed await(const Fixed* from, int version) {
#ifdef __CUDA_ARCH__
  unsigned x, y, z, w;
  do {
    asm volatile(
        "{\n\t.reg .b64 low, high;\n\t.reg .b128 all;\n\t"
        "ld.relaxed.gpu.global.b128 all, [%4];\n\tmov.b128 {low, high}, all;\n\t"
        "mov.b64 {%0, %1}, low;\n\tmov.b64 {%2, %3}, high;\n\t}"
        : "=r"(x), "=r"(y), "=r"(z), "=r"(w)
        : "l"(__cvta_generic_to_global(from))
        : "memory");
  } while (w != static_cast<unsigned>(version));
  return {static_cast<int>(x), static_cast<int>(y), static_cast<int>(z), 0.0f};
#else
  // One thread after the other: what is not there by now never comes.
  const float expected = version_bits(version);
  if (std::memcmp(&from->w, &expected, sizeof expected) != 0) std::abort();
  return *from;
#endif
}

/// Between what other blocks read once they know of a version, and that version; on either side.
PLIANT_HOST_DEVICE inline void fence_versions() {
#ifdef __CUDA_ARCH__
  __threadfence();
#endif
}

}  // namespace pliant
