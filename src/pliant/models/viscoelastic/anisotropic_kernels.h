#pragma once

#include "pliant/models/viscoelastic/nearby_ellipsoids.h"
#include "pliant/models/viscoelastic/surface_blocks.h"

namespace pliant {

/// Kernels that follow the particles about each (Yu and Turk 2013, "Reconstructing surfaces of
/// particle-based fluids using anisotropic kernels"): flat at a surface, long in a thread, round
/// within. Their shapes come from the weighted covariance of the neighbours,
///   C = Σ w (x_j − x̄)(x_j − x̄)ᵀ / Σ w,  x̄ = Σ w x_j / Σ w,  w = 1 − (r/L)³.
///
/// Unlike in the paper they keep the volume of a round kernel, whatever the body's scale, and stay
/// where their particles are, so that the body does not shrink.
class AnisotropicKernels {
 public:
  /// How much further than a round kernel of radius `support` they may reach.
  static constexpr double kReach = 1.5;

  /// For particles sorted by cubes of the edge kReach `support`; `weights` of round kernels, by
  /// rank. Those outside `blocks`, far from any surface, and those with too few about them stay
  /// round.
  void make(const NeighborLists& cells, const SurfaceBlocks& blocks,
            const Eigen::VectorXf& weights);
  const KernelEllipsoids& ellipsoids() const { return ellipsoids_; }

 private:
  void make_cell(const NeighborLists& cells, int cell, NeighborLists::RowHints& hints);

  KernelEllipsoids ellipsoids_;
};

}  // namespace pliant
