#include "pliant/models/viscoelastic/anisotropic_kernels.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "pliant/core/parallel/parallel.h"

namespace pliant {
namespace {

// The longest extent over the shortest, at most.
constexpr float kRatio = 2.5f;
// With fewer particles about it, a kernel stays round.
constexpr int kFewest = 5;
constexpr float kRadius = static_cast<float>(1.0 / AnisotropicKernels::kReach);  // of a round one
constexpr int kGrain = 16;

std::size_t at(int k) { return static_cast<std::size_t>(k); }

/// C about a particle, in edges of the cubes; false where too few are near.
bool covariance(const NeighborLists& cells, const NeighborLists::Rows& rows, int rank,
                Eigen::Matrix3f& result) {
  const auto place = [&](int of) {
    return Eigen::Vector3d(cells.along(0)[at(of)], cells.along(1)[at(of)], cells.along(2)[at(of)]);
  };
  const Eigen::Vector3d own = place(rank);
  const double scale = 1.0 / cells.radius();
  float sum = 0.0f;
  Eigen::Vector3f first = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
  int count = 0;
  for (const auto& row : rows) {
    for (int other = row[0]; other < row[1]; ++other) {
      const Eigen::Vector3f apart = (scale * (place(other) - own)).cast<float>();
      const float square = apart.squaredNorm();
      if (square >= 1.0f) continue;
      const float weight = 1.0f - square * std::sqrt(square);
      sum += weight;
      first += weight * apart;
      second += weight * apart * apart.transpose();
      ++count;
    }
  }
  const Eigen::Vector3f mean = first / sum;
  result = second / sum - mean * mean.transpose();
  return count >= kFewest;
}

}  // namespace

void AnisotropicKernels::make(const NeighborLists& cells, const SurfaceBlocks& blocks,
                              const Eigen::VectorXf& weights) {
  ellipsoids_.resize(cells.size());
  ellipsoids_.weights = weights;
  parallel_for(0, cells.cells(), kGrain, [&](int begin, int end) {
    NeighborLists::RowHints hints;
    for (int c = begin; c < end; ++c) {
      for (int rank = cells.cell_begin(c); rank < cells.cell_begin(c + 1); ++rank) {
        ellipsoids_.set(rank, Eigen::Matrix3f::Identity(), Eigen::Vector3f::Constant(kRadius));
      }
      if (blocks.find(cells.cell(c)) >= 0) make_cell(cells, c, hints);
    }
  });
}

void AnisotropicKernels::make_cell(const NeighborLists& cells, int cell,
                                   NeighborLists::RowHints& hints) {
  const NeighborLists::Rows rows = cells.rows_about(cells.cell(cell), hints);
  for (int rank = cells.cell_begin(cell); rank < cells.cell_begin(cell + 1); ++rank) {
    Eigen::Matrix3f spreads;
    if (!covariance(cells, rows, rank, spreads)) continue;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> eigen;
    eigen.computeDirect(spreads);
    const Eigen::Vector3f spread = eigen.eigenvalues();  // ascending
    if (!(spread[2] > 0.0f)) continue;
    const Eigen::Vector3f ratios = (spread / spread[2]).cwiseMax(1.0f / kRatio);
    const Eigen::Vector3f extents = kRadius * ratios / std::cbrt(ratios.prod());
    const Eigen::Vector3f cut = extents.cwiseMin(1.0f);
    ellipsoids_.set(rank, eigen.eigenvectors(), cut);
    ellipsoids_.weights[rank] *= kRadius * kRadius * kRadius / cut.prod();
  }
}

}  // namespace pliant
