#pragma once

#include <memory>

#include "pliant/solvers/backend.h"

namespace pliant {

/// DeviceSolver on the GPU, in `batch` (of make_cuda_batch()) unless that is null. Throws
/// DeviceFailure.
std::unique_ptr<Solver> make_cuda_solver(const DeviceSolverSpec& spec, SolverBatch* batch);

}  // namespace pliant
