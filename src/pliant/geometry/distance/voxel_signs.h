#pragma once

#include <Eigen/Core>
#include <vector>

namespace pliant {

/// Whether samples at (x, y, z) in [0, count), x fastest, are inside a closed mesh: by OpenVDB,
/// from `vertices` in spacings from the grid's origin. Its library takes longer to load than most
/// programs to run, so that it is loaded by the first call alone: as libpliant_voxels.so
/// (src/pliant/voxels/). Throws InputError, which says what to do, where that is not found.
std::vector<char> samples_inside(const Eigen::Matrix3Xd& vertices,
                                 const Eigen::Matrix3Xi& triangles, const Eigen::Array3i& count);

/// The function that libpliant_voxels.so exports under the name kVoxelSignsSymbol. `inside`: one a
/// sample, to be filled.
using VoxelSignsFunction = void(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles,
                                const Eigen::Array3i& count, std::vector<char>& inside);
constexpr const char* kVoxelSignsSymbol = "pliant_voxel_signs";

/// Loads `library` for good: OpenVDB's registries live as long as the process. Throws InputError.
VoxelSignsFunction* load_voxel_signs(const char* library = "libpliant_voxels.so");

}  // namespace pliant
