#include "pliant/models/viscoelastic/liquid_device.h"

#include "pliant/solvers/device/cuda_library.h"

namespace pliant {

std::unique_ptr<LiquidDevice> make_cuda_liquid() {
  std::unique_ptr<LiquidDevice> liquid;
  cuda_function<MakeCudaLiquid>(kMakeCudaLiquid)(liquid);
  return liquid;
}

}  // namespace pliant
