#include "pliant/geometry/distance/voxel_signs.h"

#include <string>

#include "pliant/math/error.h"
#include "pliant/math/loaded_library.h"

namespace pliant {

VoxelSignsFunction* load_voxel_signs(const char* library) {
  LoadedLibrary loaded(library);
  auto* function = loaded.find<VoxelSignsFunction>(kVoxelSignsSymbol);
  if (function == nullptr) {
    throw InputError(std::string("mesh shape: cannot load ") + library +
                     ", which samples meshes: " + loaded.why_not() +
                     "; it is built and installed with Pliant: put it beside libpliant_core.so");
  }
  return function;
}

std::vector<char> samples_inside(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles, const Eigen::Array3i& count) {
  static VoxelSignsFunction* const function = load_voxel_signs();
  std::vector<char> inside(static_cast<std::size_t>(count[0]) * count[1] * count[2]);
  function(vertices, triangles, count, inside);
  return inside;
}

}  // namespace pliant
