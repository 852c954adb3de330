#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/effects/device_sheet_search.h"

namespace pliant {

std::unique_ptr<SheetSearch> make_cuda_sheet_search(const SheetTreeSearch& cpu) {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  return std::make_unique<DeviceSheetSearch<CudaExecutor>>(cpu);
}

}  // namespace pliant
