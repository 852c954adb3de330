#pragma once

#include "cuda/core/host_executor.h"
#include "cuda/models/viscoelastic/blend_resident_run.h"
#include "cuda/solvers/scenes/device_solver.h"

namespace pliant {

// Compiled once, in device_solvers.cpp.
extern template class DeviceSolver<HostExecutor>;
extern template class DeviceBatch<HostExecutor>;
extern template class BlendResidentRun<HostExecutor>;

}  // namespace pliant
