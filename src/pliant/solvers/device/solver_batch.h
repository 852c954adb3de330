#pragma once

#include <memory>

#include "pliant/core/solver.h"

namespace pliant {

/// Where the solvers of many worlds meet whose work a GPU does at once. A step of a batch: every
/// world's begin_step(), run(), every world's finish_step(); the halves of different worlds may
/// run in different threads.
class SolverBatch {
 public:
  virtual ~SolverBatch() = default;
  /// A failure of the GPU reaches each solver in its finish_step().
  virtual void run() = 0;
};

/// Of the CUDA backend. Throws DeviceFailure.
std::unique_ptr<SolverBatch> make_cuda_batch();

}  // namespace pliant
