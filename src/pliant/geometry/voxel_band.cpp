#include "pliant/geometry/voxel_band.h"

#include <dlfcn.h>

#include "pliant/math/error.h"

namespace pliant {
namespace {

constexpr const char* kLibrary = "libpliant_voxels.so";

VoxelBandFunction load() {
  // Never closed: OpenVDB's registries live as long as the process.
  void* library = dlopen(kLibrary, RTLD_NOW | RTLD_LOCAL);
  void* symbol = library == nullptr ? nullptr : dlsym(library, kVoxelBandSymbol);
  if (symbol == nullptr) {
    const char* reason = dlerror();
    throw InputError(
        std::string("mesh shape: cannot load ") + kLibrary +
        ", which samples meshes: " + (reason == nullptr ? "no reason given" : reason) +
        "; it is built and installed with Pliant: put its folder into LD_LIBRARY_PATH");
  }
  return reinterpret_cast<VoxelBandFunction>(symbol);
}

}  // namespace

VoxelBand voxel_band(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                     const Eigen::Array3i& count) {
  static const VoxelBandFunction function = load();
  VoxelBand band;
  function(vertices, triangles, count, band);
  return band;
}

}  // namespace pliant
