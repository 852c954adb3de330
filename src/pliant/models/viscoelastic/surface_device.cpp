#include "pliant/models/viscoelastic/surface_device.h"

#include "pliant/solvers/device/cuda_library.h"

namespace pliant {

std::unique_ptr<SurfaceDevice> make_cuda_surface() {
  std::unique_ptr<SurfaceDevice> surface;
  cuda_function<MakeCudaSurface>(kMakeCudaSurface)(surface);
  return surface;
}

}  // namespace pliant
