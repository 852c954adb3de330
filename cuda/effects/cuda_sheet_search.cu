#include "cuda/core/cuda_executor.cuh"
#include "cuda/core/device.h"
#include "cuda/effects/device_sheet_search.h"

namespace pliant {

extern "C" void pliant_cuda_sheet_search(const SheetTreeSearch& cpu,
                                         std::unique_ptr<SheetSearch>& search) {
  const std::string reason = why_no_cuda();
  if (!reason.empty()) throw DeviceFailure(reason);
  search = std::make_unique<DeviceSheetSearch<CudaExecutor>>(cpu);
}

}  // namespace pliant
