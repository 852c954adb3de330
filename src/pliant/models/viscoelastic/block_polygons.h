#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/models/viscoelastic/surface_blocks.h"

namespace pliant {

/// Marching cubes over blocks of nodes. Many at a time; the same for any number of threads.
class BlockPolygons {
 public:
  /// `values` of all nodes, block by block; inside is what is above `level`. Node (0, 0, 0) of cell
  /// (0, 0, 0) lies at `origin`; nodes are `step` apart [m]. Cubes that a missing block leaves
  /// incomplete have no triangles.
  void make(const SurfaceBlocks& blocks, const std::vector<float>& values, float level,
            const Eigen::Vector3d& origin, double step);

  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }  ///< [m]
  /// Counter-clockwise seen from outside.
  const std::vector<Eigen::Vector3i>& triangles() const { return triangles_; }

 private:
  /// What one block has.
  struct Count {
    int vertices, triangles;
  };
  void classify(int block);
  void number_blocks();
  void add_vertices(int block);
  void add_triangles(int block);
  float value(const SurfaceBlocks::Node& node) const;

  const SurfaceBlocks* blocks_ = nullptr;
  const std::vector<float>* values_ = nullptr;
  float level_ = 0.5f;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double step_ = 1.0;
  std::vector<unsigned char> cases_;  // of the cube above each node
  std::vector<int> vertex_of_;        // three edges a node, within the block; -1: none
  std::vector<Count> counts_, firsts_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace pliant
