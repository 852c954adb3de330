#pragma once

#include <memory>

#include "pliant/solvers/backend.h"

namespace pliant {

/// DeviceSolver on the GPU. Throws DeviceFailure.
std::unique_ptr<Solver> make_cuda_solver(const DeviceSolverSpec& spec);

}  // namespace pliant
