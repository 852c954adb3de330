#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/blend_series.h"
#include "cuda/solvers/cuda_solver.h"
#include "cuda/solvers/device_solver.h"

namespace pliant {

std::string why_no_cuda() {
  const std::string reason = why_no_gpu();
  return reason.empty() ? "" : "no usable GPU: " + reason;
}

std::unique_ptr<Solver> make_cuda_solver(const DeviceSolverSpec& spec, SolverBatch* batch) {
  return std::make_unique<DeviceSolver<CudaExecutor>>(
      spec, dynamic_cast<DeviceBatch<CudaExecutor>*>(batch),
      [] { return std::make_shared<BlendSeries<CudaExecutor>>(); });
}

std::unique_ptr<SolverBatch> make_cuda_batch() {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  return std::make_unique<DeviceBatch<CudaExecutor>>();
}

}  // namespace pliant
