#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/solvers/cuda_solver.h"
#include "cuda/solvers/device_solver.h"

namespace pliant {

std::string why_no_cuda() {
  const std::string reason = why_no_gpu();
  return reason.empty() ? "" : "no usable GPU: " + reason;
}

std::unique_ptr<Solver> make_cuda_solver(const DeviceSolverSpec& spec) {
  return std::make_unique<DeviceSolver<CudaExecutor>>(spec);
}

}  // namespace pliant
