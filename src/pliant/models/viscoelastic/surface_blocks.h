#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"

namespace pliant {

/// A sparse grid: cubes of space ("blocks") with detail³ nodes each, along x fastest. The same for
/// any number of threads.
class SurfaceBlocks {
 public:
  using Cell = NeighborLists::Cell;
  struct Node {
    int block;   ///< -1: there is none
    int number;  ///< within the block
  };

  /// Blocks at the `marked` cells, in the order of NeighborLists, and at the 26 about each.
  void build(const std::vector<Cell>& marked, int detail);

  int size() const { return static_cast<int>(cells_.size()); }
  int detail() const { return detail_; }
  int nodes() const { return detail_ * detail_ * detail_; }  ///< of a block
  /// The block at a cell; -1: there is none.
  int find(const Cell& cell) const;
  const Cell& cell(int block) const { return cells_[at(block)]; }
  /// Blocks at +(0 or 1) along x, y, z; -1: none.
  const std::array<int, 8>& next(int block) const { return next_[at(block)]; }
  /// The node at (x, y, z), each from 0 to detail, counted from a block's first one.
  Node node(int block, int x, int y, int z) const;

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  void dilate(std::uint64_t offset);
  void find_next();

  int detail_ = 2;
  std::vector<std::uint64_t> keys_, below_, above_, both_;  // ascending
  std::vector<Cell> cells_;
  std::vector<std::array<int, 8>> next_;
};

}  // namespace pliant
