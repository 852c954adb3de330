#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/device_surface.h"

namespace pliant {

std::unique_ptr<SurfaceDevice> make_cuda_surface() {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  return std::make_unique<DeviceSurface<CudaExecutor>>();
}

}  // namespace pliant
