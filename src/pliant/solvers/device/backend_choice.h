#pragma once

#include <string>

#include "pliant/core/system/system.h"
#include "pliant/solvers/device/device_iteration.h"

namespace pliant {

/// What a step of a solver of iterations takes on either backend, by a model of what steps took on
/// one server with a GPU (docs/performance.md): good to a factor of two, and the same at each run,
/// since a choice by the clock would make results depend on it.
struct BackendEstimate {
  double cpu;   ///< [s]
  double cuda;  ///< [s]
};

BackendEstimate estimate_step(const ProjectiveSystem& system, int iterations, int threads,
                              const DeviceIteration& iteration = {});

/// `wanted` as a body takes it: solids sweep where they may, and with contact line_search_jacobi is
/// jacobi, as on the CPU.
DeviceIteration iteration_for(const DeviceIteration& wanted, const ProjectiveSystem& system);

/// "0.31 ms a step estimated beside 2.4 ms on the CPU".
std::string why_faster(const BackendEstimate& estimate);

}  // namespace pliant
