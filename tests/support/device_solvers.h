#pragma once

#include <memory>

#include "cuda/core/host_executor.h"
#include "cuda/models/viscoelastic/blend_series.h"
#include "cuda/solvers/device_solver.h"

namespace pliant {

/// A solver of the CUDA backend whose kernels the CPU runs, one thread after the other: the same
/// algorithm in single precision, without a GPU.
inline std::unique_ptr<Solver> make_host_device_solver(const std::string& name,
                                                       const StopRule& rule) {
  DeviceSolverSpec spec;
  spec.name = name == "chebyshev" ? "chebyshev" : "jacobi";
  spec.rule = rule;
  spec.is_accelerated = name == "chebyshev";
  spec.delay = spec.is_accelerated ? 5 : 0;
  return std::make_unique<DeviceSolver<HostExecutor>>(
      spec, nullptr, [] { return std::make_shared<BlendSeries<HostExecutor>>(); });
}

}  // namespace pliant
