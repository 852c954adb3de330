#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/device_liquid.h"

namespace pliant {

extern "C" void pliant_cuda_liquid(std::unique_ptr<LiquidDevice>& liquid) {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  liquid = std::make_unique<DeviceLiquid<CudaExecutor>>();
}

}  // namespace pliant
