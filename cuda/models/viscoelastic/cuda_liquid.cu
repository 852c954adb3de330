#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/device_liquid.h"

namespace pliant {

std::unique_ptr<LiquidDevice> make_cuda_liquid() {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  return std::make_unique<DeviceLiquid<CudaExecutor>>();
}

}  // namespace pliant
