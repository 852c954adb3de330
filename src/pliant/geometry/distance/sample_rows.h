#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Core>
#include <cstddef>

namespace pliant {

/// Calls visit(index, coordinates) for all samples of a grid, x fastest. Each row along x has a
/// visit of its own, make_visit(), and may go to any thread: what a visit keeps from one sample to
/// the next does not depend on the number of threads.
template <class MakeVisit>
void for_each_row(const Eigen::Array3i& count, const MakeVisit& make_visit) {
  const int rows = count[1] * count[2];
  tbb::parallel_for(tbb::blocked_range<int>(0, rows, 16), [&](const tbb::blocked_range<int>& part) {
    for (int row = part.begin(); row < part.end(); ++row) {
      auto visit = make_visit();
      const int y = row % count[1], z = row / count[1];
      for (int x = 0; x < count[0]; ++x) {
        visit(static_cast<std::size_t>(row) * count[0] + x, Eigen::Vector3d(x, y, z));
      }
    }
  });
}

}  // namespace pliant
