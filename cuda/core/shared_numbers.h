#pragma once

#include <cstring>

#include "pliant/math/host_device.h"

/// Numbers that many threads change together, so that what is left does not depend on their order.
namespace pliant {

using SharedCount = unsigned long long;

/// A double >= 0: larger ones have larger bits.
struct SharedExtreme {
  SharedCount bits;

  PLIANT_HOST_DEVICE static SharedExtreme of(double value) {
    SharedExtreme extreme;
#ifdef __CUDA_ARCH__
    extreme.bits = static_cast<SharedCount>(__double_as_longlong(value));
#else
    std::memcpy(&extreme.bits, &value, sizeof(value));
#endif
    return extreme;
  }
  PLIANT_HOST_DEVICE double value() const {
#ifdef __CUDA_ARCH__
    return __longlong_as_double(static_cast<long long>(bits));
#else
    double value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
#endif
  }

  /// To `value` where that is larger; what is no number changes nothing.
  PLIANT_HOST_DEVICE void raise(double value) {
    if (!(value > 0.0)) return;
    const SharedCount own = of(value).bits;
#ifdef __CUDA_ARCH__
    if (own > *static_cast<volatile SharedCount*>(&bits)) atomicMax(&bits, own);
#else
    if (own > bits) bits = own;
#endif
  }
  PLIANT_HOST_DEVICE void lower(double value) {
    if (!(value >= 0.0)) return;
    const SharedCount own = of(value).bits;
#ifdef __CUDA_ARCH__
    if (own < *static_cast<volatile SharedCount*>(&bits)) atomicMin(&bits, own);
#else
    if (own < bits) bits = own;
#endif
  }
};

PLIANT_HOST_DEVICE inline void add_shared(SharedCount* sum, SharedCount value) {
#ifdef __CUDA_ARCH__
  atomicAdd(sum, value);
#else
  *sum += value;
#endif
}

}  // namespace pliant
