#pragma once

#include "pliant/math/vector_traits.h"

namespace pliant {

/// The nearest friction force in Coulomb's disk |f| ≤ `bound`.
template <class V>
PLIANT_HOST_DEVICE inline V within_disk(const V& force, NumberOf<V> bound) {
  const auto size = VectorTraits<V>::length(force);
  return size > bound ? V((bound / size) * force) : force;
}

}  // namespace pliant
