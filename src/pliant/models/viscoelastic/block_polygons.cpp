#include "pliant/models/viscoelastic/block_polygons.h"

#include <algorithm>

#include "pliant/core/parallel/parallel.h"
#include "pliant/geometry/meshing/marching_cubes.h"

namespace pliant {
namespace {

constexpr int kGrain = 64;
// Of an edge: not onto a node, where triangles would have no area.
constexpr double kOffNodes = 1e-3;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// Calls visit(x, y, z, number) for the nodes of a block.
template <class Visit>
void for_each_node(int detail, const Visit& visit) {
  int number = 0;
  for (int z = 0; z < detail; ++z) {
    for (int y = 0; y < detail; ++y) {
      for (int x = 0; x < detail; ++x, ++number) visit(x, y, z, number);
    }
  }
}

}  // namespace

float BlockPolygons::value(const SurfaceBlocks::Node& node) const {
  return (*values_)[at(node.block) * at(blocks_->nodes()) + at(node.number)];
}

void BlockPolygons::make(const SurfaceBlocks& blocks, const std::vector<float>& values, float level,
                         const Eigen::Vector3d& origin, double step) {
  blocks_ = &blocks;
  values_ = &values;
  level_ = level;
  origin_ = origin;
  step_ = step;
  cases_.resize(values.size());
  vertex_of_.resize(3 * values.size());
  counts_.resize(at(blocks.size()));
  const auto for_each_block = [&](auto visit) {
    parallel_for(0, blocks.size(), kGrain, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) visit(b);
    });
  };
  for_each_block([this](int block) { classify(block); });
  number_blocks();
  for_each_block([this](int block) {
    if (counts_[at(block)].vertices > 0) add_vertices(block);
    if (counts_[at(block)].triangles > 0) add_triangles(block);
  });
}

void BlockPolygons::classify(int block) {
  Count count{0, 0};
  const std::size_t first = at(block) * at(blocks_->nodes());
  for_each_node(blocks_->detail(), [&](int x, int y, int z, int number) {
    int inside = 0;
    bool is_complete = true;
    for (int corner = 0; corner < 8; ++corner) {
      const SurfaceBlocks::Node node =
          blocks_->node(block, x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1));
      is_complete &= node.block >= 0;
      if (node.block >= 0 && value(node) > level_) inside |= 1 << corner;
    }
    const int shape = is_complete ? inside : 0;
    cases_[first + at(number)] = static_cast<unsigned char>(shape);
    count.triangles += static_cast<int>(MarchingCubes::triangles(shape).size());
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_other_there =
          blocks_->node(block, x + (axis == 0), y + (axis == 1), z + (axis == 2)).block >= 0;
      const bool crosses = is_other_there && (inside & 1) != (inside >> (1 << axis) & 1);
      vertex_of_[(first + at(number)) * 3 + at(axis)] = crosses ? count.vertices++ : -1;
    }
  });
  counts_[at(block)] = count;
}

void BlockPolygons::number_blocks() {
  firsts_.resize(counts_.size());
  Count sum{0, 0};
  for (std::size_t b = 0; b < counts_.size(); ++b) {
    firsts_[b] = sum;
    sum.vertices += counts_[b].vertices;
    sum.triangles += counts_[b].triangles;
  }
  vertices_.resize(at(sum.vertices));
  triangles_.resize(at(sum.triangles));
}

void BlockPolygons::add_vertices(int block) {
  const int detail = blocks_->detail();
  const std::size_t first = at(block) * at(blocks_->nodes());
  const Eigen::Vector3d corner = origin_ + detail * step_ * blocks_->cell(block).cast<double>();
  for_each_node(detail, [&](int x, int y, int z, int number) {
    const int* const edges = &vertex_of_[(first + at(number)) * 3];
    for (int axis = 0; axis < 3; ++axis) {
      if (edges[axis] < 0) continue;
      const float a = value({block, number});
      const float b =
          value(blocks_->node(block, x + (axis == 0), y + (axis == 1), z + (axis == 2)));
      Eigen::Vector3d place(x, y, z);
      place[axis] +=
          std::clamp(static_cast<double>((level_ - a) / (b - a)), kOffNodes, 1.0 - kOffNodes);
      vertices_[at(firsts_[at(block)].vertices + edges[axis])] = corner + step_ * place;
    }
  });
}

void BlockPolygons::add_triangles(int block) {
  const std::size_t first = at(block) * at(blocks_->nodes());
  int next = firsts_[at(block)].triangles;
  for_each_node(blocks_->detail(), [&](int x, int y, int z, int number) {
    for (const MarchingCubes::Triangle& triangle :
         MarchingCubes::triangles(cases_[first + at(number)])) {
      for (int k = 0; k < 3; ++k) {
        const int edge = triangle[at(k)], corner = MarchingCubes::edge_corner(edge);
        const SurfaceBlocks::Node low =
            blocks_->node(block, x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2 & 1));
        const std::size_t of = at(low.block) * at(blocks_->nodes()) + at(low.number);
        triangles_[at(next)][k] = firsts_[at(low.block)].vertices +
                                  vertex_of_[of * 3 + at(MarchingCubes::edge_axis(edge))];
      }
      ++next;
    }
  });
}

}  // namespace pliant
