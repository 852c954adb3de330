#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "cuda/core/prefix_sums.h"
#include "cuda/core/upload.h"
#include "cuda/models/viscoelastic/surface_polygons.h"
#include "cuda/models/viscoelastic/surface_sums.h"
#include "pliant/geometry/meshing/marching_cubes.h"
#include "pliant/models/viscoelastic/surface_device.h"
#include "pliant/solvers/device/backend.h"

namespace pliant {

/// Surfaces about particles by an executor. Cells and blocks are the CPU's, which sorts; the sums
/// over particles and the marching cubes are made here, and the polygons alone come back.
template <class Executor>
class DeviceSurface final : public SurfaceDevice {
 public:
  DeviceSurface() { bind_table(); }
  bool weigh(const NeighborLists& cells, const Eigen::VectorXf& weights,
             std::vector<char>& at_boundary) override;
  void make(const NeighborLists& cells, const SurfaceBlocks& blocks,
            std::vector<Eigen::Vector3d>& vertices,
            std::vector<Eigen::Vector3i>& triangles) override;

 private:
  static constexpr int kGrain = 4096;
  // Quanta of 2^-22 of a cell: differences within three cells are exact in single precision.
  static constexpr int kFinest = 22, kCoarsest = 18, kRange = 30;
  template <class T>
  using Array = typename Executor::template Array<T>;
  template <class T>
  using Staged = typename Executor::template Staged<T>;

  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  template <class T>
  static void grow(Array<T>& array, std::size_t size) {
    if (array.size() < size) array.resize(size + size / 2);
  }
  static Fixed fixed(const Eigen::Vector3i& v) { return {v[0], v[1], v[2], 0.0f}; }
  void bind_table();
  bool choose_bits(const NeighborLists& cells);
  void upload_particles(const NeighborLists& cells, const Eigen::VectorXf& weights);
  SurfaceRows find_rows(const Array<Fixed>& cells, int count);
  void fill(const SurfaceBlocks& blocks);
  void count(int blocks);

  Executor executor_;
  SurfaceParticles particles_;
  SurfaceGrid grid_;
  CubeTable table_;
  Staged<Fixed> staged_x_, staged_cells_;
  Staged<std::uint64_t> staged_keys_;
  Staged<int> staged_firsts_, staged_next_;
  Array<std::uint64_t> keys_;
  Array<int> firsts_, row_begins_, row_ends_, next_, vertex_of_, table_begins_, table_edges_;
  Array<Fixed> x_, cells_, block_cells_;
  Array<float> weights_, values_;
  Array<char> at_boundary_;
  Array<unsigned char> cases_;
  Array<int> vertex_counts_, triangle_counts_, vertex_firsts_, triangle_firsts_, run_sums_, counts_;
  Array<double> vertices_;
  Array<int> triangles_;
};

template <class Executor>
void DeviceSurface<Executor>::bind_table() {
  std::vector<int> begins(1, 0), edges;
  for (int shape = 0; shape < 256; ++shape) {
    for (const MarchingCubes::Triangle& triangle : MarchingCubes::triangles(shape)) {
      edges.insert(edges.end(), triangle.begin(), triangle.end());
    }
    begins.push_back(static_cast<int>(edges.size()) / 3);
  }
  upload_all(executor_, table_begins_, begins);
  upload_all(executor_, table_edges_, edges);
  executor_.synchronize();
  table_ = {table_begins_.data(), table_edges_.data()};
  counts_.resize(2);
}

template <class Executor>
bool DeviceSurface<Executor>::choose_bits(const NeighborLists& cells) {
  int most = 0;
  for (int c = 0; c < cells.cells(); ++c) most = std::max(most, cells.cell(c).maxCoeff());
  particles_.bits = kFinest;
  while (particles_.bits >= kCoarsest && most + 3 > 1 << (kRange - particles_.bits)) {
    --particles_.bits;
  }
  return particles_.bits >= kCoarsest;
}

template <class Executor>
void DeviceSurface<Executor>::upload_particles(const NeighborLists& cells,
                                               const Eigen::VectorXf& weights) {
  const double scale = static_cast<double>(1 << particles_.bits) / cells.radius();
  staged_x_.resize(at(cells.size()));
  parallel_for(0, cells.size(), kGrain, [&](int begin, int end) {
    for (int rank = begin; rank < end; ++rank) {
      const auto whole = [&](int axis) {
        return static_cast<int>(
            std::lrint(scale * (cells.along(axis)[at(rank)] - cells.origin()[axis])));
      };
      staged_x_[at(rank)] = {whole(0), whole(1), whole(2), weights[rank]};
    }
  });
  staged_cells_.resize(at(cells.cells()));
  staged_keys_.resize(at(cells.cells()));
  staged_firsts_.resize(at(cells.cells() + 1));
  for (int c = 0; c < cells.cells(); ++c) {
    const Eigen::Vector3i cell = cells.cell(c);
    staged_cells_[at(c)] = fixed(cell);
    staged_keys_[at(c)] = surface_key(cell[0], cell[1], cell[2]);
  }
  for (int c = 0; c <= cells.cells(); ++c) staged_firsts_[at(c)] = cells.cell_begin(c);
  upload_all(executor_, x_, staged_x_);
  upload_all(executor_, cells_, staged_cells_);
  upload_all(executor_, keys_, staged_keys_);
  upload_all(executor_, firsts_, staged_firsts_);
  grow(weights_, staged_x_.size());
  particles_.keys = keys_.data();
  particles_.firsts = firsts_.data();
  particles_.cells = cells.cells();
  particles_.x = x_.data();
  particles_.weights = weights_.data();
}

template <class Executor>
SurfaceRows DeviceSurface<Executor>::find_rows(const Array<Fixed>& cells, int count) {
  grow(row_begins_, at(FindRows::kRows * count));
  grow(row_ends_, at(FindRows::kRows * count));
  executor_.launch(count,
                   FindRows{particles_, cells.data(), count, row_begins_.data(), row_ends_.data()});
  return {cells.data(), row_begins_.data(), row_ends_.data(), count};
}

template <class Executor>
bool DeviceSurface<Executor>::weigh(const NeighborLists& cells, const Eigen::VectorXf& weights,
                                    std::vector<char>& at_boundary) {
  if (!choose_bits(cells)) return false;
  upload_particles(cells, weights);
  at_boundary.assign(at(cells.cells()), 0);
  upload_all(executor_, at_boundary_, at_boundary);
  const SurfaceRows rows = find_rows(cells_, cells.cells());
  executor_.launch(cells.size(),
                   WeighSurface{particles_, rows, weights_.data(), at_boundary_.data()});
  executor_.download(at_boundary.data(), at_boundary_, at_boundary.size());
  return true;
}

template <class Executor>
void DeviceSurface<Executor>::fill(const SurfaceBlocks& blocks) {
  const int count = blocks.size();
  staged_cells_.resize(at(count));
  staged_next_.resize(at(8 * count));
  for (int b = 0; b < count; ++b) {
    staged_cells_[at(b)] = fixed(blocks.cell(b));
    std::copy(blocks.next(b).begin(), blocks.next(b).end(), staged_next_.begin() + 8 * b);
  }
  upload_all(executor_, block_cells_, staged_cells_);
  upload_all(executor_, next_, staged_next_);
  const int nodes = count * blocks.nodes();
  grow(values_, at(nodes));
  grow(cases_, at(nodes));
  grow(vertex_of_, at(3 * nodes));
  const SurfaceRows rows = find_rows(block_cells_, count);
  executor_.launch(nodes, FillNodes{particles_, rows, blocks.detail(), values_.data()});
  grid_ = {blocks.detail(),       block_cells_.data(), next_.data(),     values_.data(),
           SurfaceLimits::kLevel, cases_.data(),       vertex_of_.data()};
}

template <class Executor>
void DeviceSurface<Executor>::count(int blocks) {
  // One more than there are blocks, so that the last sum is that of all.
  const int size = whole_prefix_runs(blocks + 1);
  for (Array<int>* array : {&vertex_counts_, &triangle_counts_}) {
    grow(*array, at(size));
    executor_.launch(size, ClearCounts{array->data()});
  }
  for (Array<int>* array : {&vertex_firsts_, &triangle_firsts_}) grow(*array, at(size));
  grow(run_sums_, at(size / kPrefixRun));
  executor_.launch(blocks,
                   ClassifyNodes{grid_, table_, vertex_counts_.data(), triangle_counts_.data()});
  sum_before(executor_, vertex_counts_.data(), size, run_sums_.data(), vertex_firsts_.data(), -1);
  sum_before(executor_, triangle_counts_.data(), size, run_sums_.data(), triangle_firsts_.data(),
             -1);
  executor_.launch(
      1, CountAll{vertex_firsts_.data(), triangle_firsts_.data(), blocks, counts_.data()});
}

template <class Executor>
void DeviceSurface<Executor>::make(const NeighborLists& cells, const SurfaceBlocks& blocks,
                                   std::vector<Eigen::Vector3d>& vertices,
                                   std::vector<Eigen::Vector3i>& triangles) {
  fill(blocks);
  count(blocks.size());
  int counts[2] = {0, 0};
  executor_.download(counts, counts_, 2);
  vertices.resize(at(counts[0]));
  triangles.resize(at(counts[1]));
  if (counts[1] == 0) return;
  grow(vertices_, 3 * vertices.size());
  grow(triangles_, 3 * triangles.size());
  const Eigen::Vector3d& o = cells.origin();
  const double step = cells.radius() / blocks.detail();
  executor_.launch(
      blocks.size(),
      PlaceVertices{grid_, vertex_firsts_.data(), {o[0], o[1], o[2]}, step, vertices_.data()});
  executor_.launch(blocks.size(), PlaceTriangles{grid_, table_, triangle_firsts_.data(),
                                                 vertex_firsts_.data(), triangles_.data()});
  executor_.download(vertices.front().data(), vertices_, 3 * vertices.size());
  executor_.download(triangles.front().data(), triangles_, 3 * triangles.size());
}

}  // namespace pliant
