#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

/// What a grid of samples knows of a closed mesh, at (x, y, z) in [0, count), x fastest.
struct VoxelBand {
  std::vector<char> inside;
  std::vector<int> triangle;  ///< the nearest one; -1 beyond three spacings from the surface
};

/// By OpenVDB, from `vertices` in spacings from the grid's origin. Its library takes longer to load
/// than most programs to run, so that it is loaded by the first call alone: as libpliant_voxels.so
/// (src/pliant/voxels/). Throws InputError, which says what to do, where that is not found.
VoxelBand voxel_band(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                     const Eigen::Array3i& count);

/// The function that libpliant_voxels.so exports under the name kVoxelBandSymbol.
using VoxelBandFunction = void(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                               const Eigen::Array3i& count, VoxelBand& band);
constexpr const char* kVoxelBandSymbol = "pliant_voxel_band";

/// Loads `library` for good: OpenVDB's registries live as long as the process. Throws InputError.
VoxelBandFunction* load_voxel_band(const char* library = "libpliant_voxels.so");

}  // namespace pliant
