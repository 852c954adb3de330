#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "pliant/core/body/particles.h"
#include "pliant/core/parallel/parallel_reduce.h"

/// Work on all columns of a 3 x n matrix, one a particle, in threads.
namespace pliant {

/// Columns below which threads cost more than they save.
constexpr int kColumnGrain = 4096;
constexpr int kLoopGrain = 1024;

template <class Use>
void for_each_column(const Eigen::Matrix3Xd& columns, const Use& use) {
  parallel_for(0, static_cast<int>(columns.cols()), kLoopGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) use(i);
  });
}

inline void parallel_copy(const Eigen::Matrix3Xd& from, Eigen::Matrix3Xd& to) {
  to.resize(3, from.cols());
  parallel_for(0, static_cast<int>(from.cols()), kLoopGrain, [&](int begin, int end) {
    to.middleCols(begin, end - begin) = from.middleCols(begin, end - begin);
  });
}

inline void parallel_zero(Eigen::Index count, Eigen::Matrix3Xd& to) {
  to.resize(3, count);
  parallel_for(0, static_cast<int>(count), kLoopGrain,
               [&](int begin, int end) { to.middleCols(begin, end - begin).setZero(); });
}

/// What holds all columns.
inline Eigen::AlignedBox3d box_of(const Eigen::Matrix3Xd& columns) {
  return parallel_reduce(
      0, static_cast<int>(columns.cols()), kColumnGrain,
      [&](int begin, int end) {
        Eigen::AlignedBox3d box;
        for (int i = begin; i < end; ++i) box.extend(columns.col(i));
        return box;
      },
      [](const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b) { return a.merged(b); });
}

/// Largest |coordinate|; 0 of no columns.
inline double largest_coordinate(const Eigen::Matrix3Xd& columns) {
  return parallel_reduce(
      0, static_cast<int>(columns.cols()), kColumnGrain,
      [&](int begin, int end) {
        if (begin == end) return 0.0;
        return columns.middleCols(begin, end - begin).cwiseAbs().maxCoeff();
      },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace pliant
