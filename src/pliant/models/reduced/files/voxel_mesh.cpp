#include "pliant/models/reduced/files/voxel_mesh.h"

#include <vector>

#include "pliant/math/error.h"

namespace pliant {
namespace {

/// Vertices of `block` in the tetrahedra kept, in their order, and the tetrahedra with new indices.
TetrahedralMesh without_unused(const TetrahedralMesh& block, const std::vector<int>& kept) {
  std::vector<int> number(static_cast<std::size_t>(block.vertices.cols()), -1);
  TetrahedralMesh mesh;
  mesh.tetrahedra.resize(4, static_cast<Eigen::Index>(kept.size()));
  for (const int t : kept) {
    for (int c = 0; c < 4; ++c) number[static_cast<std::size_t>(block.tetrahedra(c, t))] = 0;
  }
  int count = 0;
  for (int& n : number) {
    if (n == 0) n = count++;
  }
  mesh.vertices.resize(3, count);
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] >= 0) {
      mesh.vertices.col(number[v]) = block.vertices.col(static_cast<Eigen::Index>(v));
    }
  }
  for (std::size_t k = 0; k < kept.size(); ++k) {
    for (int c = 0; c < 4; ++c) {
      mesh.tetrahedra(c, static_cast<Eigen::Index>(k)) =
          number[static_cast<std::size_t>(block.tetrahedra(c, kept[k]))];
    }
  }
  return mesh;
}

}  // namespace

TetrahedralMesh mesh_voxels(const VoxelGrid& grid,
                            const std::function<bool(const Eigen::Vector3d&)>& is_inside,
                            const std::string& name) {
  const Eigen::Vector3d size = grid.high - grid.low;
  TetrahedralMesh block = make_block({size, grid.cells});
  block.vertices.colwise() += 0.5 * (grid.low + grid.high);
  constexpr int kPerCell = 5;
  std::vector<int> kept;
  int t = 0;
  for (int k = 0; k < grid.cells[2]; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i, t += kPerCell) {
        const Eigen::Array3d share =
            (Eigen::Array3d(i, j, k) + 0.5) / grid.cells.cast<double>().array();
        if (!is_inside(grid.low + (share * size.array()).matrix())) continue;
        for (int c = 0; c < kPerCell; ++c) kept.push_back(t + c);
      }
    }
  }
  if (kept.empty()) throw InputError(name + ": no cell of the grid is inside");
  return without_unused(block, kept);
}

}  // namespace pliant
