#include "pliant/models/viscoelastic/surface_device.h"

#include "pliant/solvers/backend.h"

namespace pliant {

#ifndef PLIANT_CUDA_BACKEND
std::unique_ptr<SurfaceDevice> make_cuda_surface() { throw DeviceFailure(why_no_cuda()); }
#endif

}  // namespace pliant
