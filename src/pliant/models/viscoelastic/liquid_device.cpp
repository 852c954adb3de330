#include "pliant/models/viscoelastic/liquid_device.h"

#include "pliant/solvers/backend.h"

namespace pliant {

#ifndef PLIANT_CUDA_BACKEND
std::unique_ptr<LiquidDevice> make_cuda_liquid() { throw DeviceFailure(why_no_cuda()); }
#endif

}  // namespace pliant
