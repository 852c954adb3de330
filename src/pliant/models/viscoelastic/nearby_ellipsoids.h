#pragma once

#include <Eigen/Core>
#include <vector>

#include "pliant/core/system/neighbor_lists.h"

namespace pliant {

/// The kernels of particles as ellipsoids: w (1 − (x − x_i)ᵀ M (x − x_i))³, by rank. Lengths
/// are in edges of the cubes that the particles are sorted by.
struct KernelEllipsoids {
  Eigen::Matrix<float, 6, Eigen::Dynamic>
      m;                    ///< xx, yy, zz, xy, yz, zx of M; none reaches beyond 1
  Eigen::VectorXf weights;  ///< w

  void resize(int count);
  /// `axes` orthonormal, `extents` along them.
  void set(int rank, const Eigen::Matrix3f& axes, const Eigen::Vector3f& extents);
};

/// The kernels in and about one cube of space, side by side, for sums over them at points of that
/// cube, in edges of it from its lowest corner.
class NearbyEllipsoids {
 public:
  /// Fast where the next call's cube comes a little after this one's.
  void gather(const NeighborLists& lists, const KernelEllipsoids& kernels,
              const NeighborLists::Cell& cell);
  /// Σ of the kernels at `point`.
  float sum(const Eigen::Vector3f& point);

 private:
  int count_ = 0;
  // x, y, z of the centre; xx, yy, zz, xy, yz, zx of M, the last three doubled; w
  Eigen::Array<float, Eigen::Dynamic, 10> columns_;
  NeighborLists::RowHints hints_;
};

}  // namespace pliant
