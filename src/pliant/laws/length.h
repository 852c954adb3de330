#pragma once

#include "pliant/math/vector_traits.h"

namespace pliant {

/// A length that something is divided by: a vector without a direction exerts no force. What is no
/// number stays none.
template <typename T>
PLIANT_HOST_DEVICE inline T divisor(T length) {
  return greater(length, kNoDirection<T>);
}
template <class V>
PLIANT_HOST_DEVICE inline NumberOf<V> divisor_of(const V& a) {
  return divisor(VectorTraits<V>::length(a));
}

}  // namespace pliant
