#include "pliant/geometry/voxel_band.h"

#include <dlfcn.h>

#include <string>

#include "pliant/math/error.h"

namespace pliant {

VoxelBandFunction load_voxel_band(const char* library) {
  void* loaded = dlopen(library, RTLD_NOW | RTLD_LOCAL);
  void* symbol = loaded == nullptr ? nullptr : dlsym(loaded, kVoxelBandSymbol);
  if (symbol == nullptr) {
    const char* reason = dlerror();
    throw InputError(
        std::string("mesh shape: cannot load ") + library +
        ", which samples meshes: " + (reason == nullptr ? "no reason given" : reason) +
        "; it is built and installed with Pliant: put its folder into LD_LIBRARY_PATH");
  }
  return reinterpret_cast<VoxelBandFunction>(symbol);
}

VoxelBand voxel_band(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                     const Eigen::Array3i& count) {
  static const VoxelBandFunction function = load_voxel_band();
  VoxelBand band;
  function(vertices, triangles, count, band);
  return band;
}

}  // namespace pliant
