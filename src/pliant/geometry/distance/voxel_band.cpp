#include "pliant/geometry/distance/voxel_band.h"

#include <string>

#include "pliant/math/error.h"
#include "pliant/math/loaded_library.h"

namespace pliant {

VoxelBandFunction* load_voxel_band(const char* library) {
  LoadedLibrary loaded(library);
  auto* function = loaded.find<VoxelBandFunction>(kVoxelBandSymbol);
  if (function == nullptr) {
    throw InputError(std::string("mesh shape: cannot load ") + library +
                     ", which samples meshes: " + loaded.why_not() +
                     "; it is built and installed with Pliant: put it beside libpliant_core.so");
  }
  return function;
}

VoxelBand voxel_band(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                     const Eigen::Array3i& count) {
  static VoxelBandFunction* const function = load_voxel_band();
  VoxelBand band;
  function(vertices, triangles, count, band);
  return band;
}

}  // namespace pliant
