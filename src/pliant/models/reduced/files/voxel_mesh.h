#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// Cubes of a grid cut into tetrahedra.
struct VoxelGrid {
  Eigen::Vector3d low, high;  ///< corners of the region [m]
  Eigen::Vector3i cells;      ///< along x, y, z; at least 1
};

/// Tetrahedra of the cells whose centre `is_inside` says to be solid, five a cell as in
/// make_block(). Throws InputError, beginning with `name`, when there is none.
TetrahedralMesh mesh_voxels(const VoxelGrid& grid,
                            const std::function<bool(const Eigen::Vector3d&)>& is_inside,
                            const std::string& name);

}  // namespace pliant
