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

/// Makes a solver with the backend `cuda`, or `auto`, one of the batch, which must outlive it; it
/// has to be prepared again. False for any other, which steps as it does alone.
bool join_batch(Solver& solver, SolverBatch& batch);

}  // namespace pliant
