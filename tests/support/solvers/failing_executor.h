#pragma once

#include "cuda/core/host_executor.h"

namespace pliant {

/// As a GPU that is out of memory from its `left`th launch on.
class FailingExecutor : public HostExecutor {
 public:
  static inline int left = 1;

  template <class F>
  void launch(int n, const F& f) {
    if (--left <= 0) throw DeviceFailure("out of memory");
    HostExecutor::launch(n, f);
  }
};

}  // namespace pliant
