#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/blend_resident_run.h"
#include "cuda/solvers/scenes/device_solver.h"

namespace pliant {

extern "C" void pliant_cuda_why_not(std::string& reason) {
  reason = why_no_gpu();
  if (!reason.empty()) reason = "no usable GPU: " + reason;
}

extern "C" void pliant_cuda_solver(const DeviceSolverSpec& spec, SolverBatch* batch,
                                   std::unique_ptr<Solver>& solver) {
  solver = std::make_unique<DeviceSolver<CudaExecutor>>(
      spec, dynamic_cast<DeviceBatch<CudaExecutor>*>(batch),
      [] { return std::make_shared<BlendResidentRun<CudaExecutor>>(); });
}

extern "C" void pliant_cuda_batch(std::unique_ptr<SolverBatch>& batch) {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  batch = std::make_unique<DeviceBatch<CudaExecutor>>();
}

}  // namespace pliant
