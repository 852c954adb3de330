#pragma once

#include "pliant/laws/length.h"

namespace pliant {

/// A spring pulls its end at i by s d, d = xⱼ − xᵢ, where s = k (1 − l₀/|d|) [N/m].
template <typename T>
PLIANT_HOST_DEVICE inline T spring_share(T stiffness, T rest_length, T length) {
  return stiffness * (T(1) - rest_length / length);
}

/// Shear of a cell: its diagonals d and e pull like springs of the energy k/2 (|d| − |e|)², d by
/// this times d.
template <typename T>
PLIANT_HOST_DEVICE inline T cell_share(T stiffness, T length, T other_length) {
  return stiffness * (length - other_length) / length;
}

}  // namespace pliant
