#pragma once

#include <array>
#include <vector>

#include "pliant/core/neighbor_lists.h"
#include "pliant/geometry/triangle_mesh.h"

namespace pliant {

/// A closed surface around particles: marching cubes of their colour field Σ V W (Müller et al.
/// 2003) at one half, where a flat boundary truly is. Only cubes near particles at the boundary are
/// visited.
class ParticleSurface {
 public:
  /// Marching cubes have the edge `support` / `detail` [m], detail >= 2.
  void update(const Eigen::Matrix3Xd& x, const Eigen::VectorXd& volumes, double support,
              int detail);

  const TriangleMesh& mesh() const { return mesh_; }
  /// What a field of the particles is at the vertices.
  Eigen::VectorXd interpolate(const Eigen::VectorXd& field) const;
  /// The positions that it was made for.
  const Eigen::Matrix3Xd& positions() const { return x_; }

 private:
  struct Block {
    NeighborLists::Cell cell;
    std::array<int, 8> neighbors;  // blocks at +(0 or 1) along x, y, z; -1: none
  };

  void find_blocks();
  void fill_block(int block);
  void polygonise();
  void drop_small_parts();
  int vertex_on(int block, const Eigen::Array3i& node, int axis);
  /// The block and the number within it of a node, counted from a block's first; block -1: none.
  std::array<int, 2> locate(int block, const Eigen::Array3i& node) const;
  Eigen::Vector3d position(int block, const Eigen::Array3i& node) const;
  float value(const std::array<int, 2>& node) const;

  Eigen::Matrix3Xd x_;
  Eigen::VectorXd volumes_;
  double support_ = 1.0, step_ = 1.0;
  int detail_ = 2;
  NeighborLists lists_;
  std::vector<Block> blocks_;
  std::vector<double> weights_;  // volumes that particles count for, by rank [m³]
  std::vector<float> values_;    // detail³ a block
  std::vector<int> vertex_of_;   // three edges a node
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
  TriangleMesh mesh_;
};

}  // namespace pliant
