#pragma once

#include "pliant/math/vector_traits.h"

namespace pliant {

/// Where a fibre points that lay along the first rest axis, from the columns of G: along the first
/// one. Where that is pressed to a point, it springs back along the normal of what lies across it,
/// or else along x.
template <class V>
PLIANT_HOST_DEVICE inline V fiber_direction(const V& g0, const V& g1, const V& g2) {
  using Traits = VectorTraits<V>;
  using T = NumberOf<V>;
  if (Traits::has_direction(g0)) return Traits::direction(g0);
  const V normal = Traits::cross_product(g1, g2);
  return Traits::has_direction(normal) ? Traits::direction(normal) : V{T(1), T(0), T(0)};
}

/// The first column of Ψ' per stiffness, with Ψ = 1/2 (|g₀| − 1)²; the others are zero.
template <class V>
PLIANT_HOST_DEVICE inline V fiber_stress(const V& g0, const V& g1, const V& g2) {
  return g0 - fiber_direction(g0, g1, g2);
}

}  // namespace pliant
