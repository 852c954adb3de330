#pragma once

#include <tbb/blocked_range2d.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>

#include "pliant/geometry/search/mesh_distances.h"

namespace pliant {

/// Calls visit(indices, coordinates) for all samples of a grid, in blocks of two along each axis,
/// x fastest; a block at a side beyond which nothing is left holds some of them twice. Each row of
/// blocks along x has a visit of its own, make_visit(), and may go to any thread: what a visit
/// keeps from one block to the next does not depend on the number of threads.
template <class MakeVisit>
void for_each_block(const Eigen::Array3i& count, const MakeVisit& make_visit) {
  static_assert(MeshDistances::kLanes == 8);
  using Rows = tbb::blocked_range2d<int>;
  const Eigen::Array3i last = count - 1;
  tbb::parallel_for(
      Rows(0, (count[2] + 1) / 2, 4, 0, (count[1] + 1) / 2, 4), [&](const Rows& rows) {
        for (int row = rows.rows().begin(); row < rows.rows().end(); ++row) {
          for (int column = rows.cols().begin(); column < rows.cols().end(); ++column) {
            auto visit = make_visit();
            for (int x = 0; x < count[0]; x += 2) {
              std::array<std::size_t, MeshDistances::kLanes> indices;
              MeshDistances::Points at;
              for (std::size_t l = 0; l < indices.size(); ++l) {
                const int i = std::min(x + static_cast<int>(l & 1u), last[0]);
                const int j = std::min(2 * column + static_cast<int>(l >> 1u & 1u), last[1]);
                const int k = std::min(2 * row + static_cast<int>(l >> 2u), last[2]);
                indices[l] = (static_cast<std::size_t>(k) * count[1] + j) * count[0] + i;
                at.x[l] = i;
                at.y[l] = j;
                at.z[l] = k;
              }
              visit(indices, at);
            }
          }
        }
      });
}

}  // namespace pliant
