#pragma once

#include <memory>
#include <string>

#include "pliant/solvers/device/backend.h"

namespace pliant {

/// As the registry's entry of that name with its default parameters.
DeviceSolverSpec device_solver_spec(const std::string& name, const StopRule& rule);

/// A solver of the CUDA backend whose kernels the CPU runs, one thread after the other: the same
/// algorithm in single precision, without a GPU.
std::unique_ptr<Solver> make_host_device_solver(const DeviceSolverSpec& spec);
std::unique_ptr<Solver> make_host_device_solver(const std::string& name, const StopRule& rule);

}  // namespace pliant
