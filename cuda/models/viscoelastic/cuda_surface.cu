#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/models/viscoelastic/device_surface.h"

namespace pliant {

extern "C" void pliant_cuda_surface(std::unique_ptr<SurfaceDevice>& surface) {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  surface = std::make_unique<DeviceSurface<CudaExecutor>>();
}

}  // namespace pliant
