#pragma once

namespace pliant {

/// Three coordinates in a vector register, and a fourth number that nothing uses. A coordinate has
/// the bits that it would have alone.
using Coordinates = double __attribute__((vector_size(4 * sizeof(double))));

inline void load(const double* from, Coordinates& to) {
  to = Coordinates{from[0], from[1], from[2], 0.0};
}
// Number by number: three of them together would go by way of memory.
inline void store(const Coordinates& from, double* to) {
  for (int c = 0; c < 3; ++c) to[c] = from[c];
}

}  // namespace pliant
