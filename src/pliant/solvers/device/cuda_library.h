#pragma once

#include <memory>
#include <string>

#include "pliant/math/loaded_library.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// libpliant_cuda.so, the CUDA backend: it knows this library, and this one knows functions of it
/// by their C names alone.
LoadedLibrary& cuda_library();
/// Where it or one of its functions is not there. Says what to do about it.
std::string why_no_cuda_library();

/// A function of the CUDA backend. Throws DeviceFailure where it is not there.
template <class Function>
Function& cuda_function(const char* symbol) {
  auto* function = cuda_library().find<Function>(symbol);
  if (function == nullptr) throw DeviceFailure(why_no_cuda_library());
  return *function;
}

/// Makes a solver that runs on the GPU, in `batch` (of make_cuda_batch()) unless that is null.
/// Throws DeviceFailure.
using MakeCudaSolver = void(const DeviceSolverSpec& spec, SolverBatch* batch,
                            std::unique_ptr<Solver>& solver);
constexpr const char* kMakeCudaSolver = "pliant_cuda_solver";

/// Makes what make_cuda_batch() returns.
using MakeCudaBatch = void(std::unique_ptr<SolverBatch>& batch);
constexpr const char* kMakeCudaBatch = "pliant_cuda_batch";

/// Tells why there is no GPU; nothing where there is one.
using TellWhyNoGpu = void(std::string& reason);
constexpr const char* kTellWhyNoGpu = "pliant_cuda_why_not";

}  // namespace pliant
