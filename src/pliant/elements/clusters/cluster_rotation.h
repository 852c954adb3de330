#pragma once

#include <Eigen/Core>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// The rotation nearest to a cluster's moment; a function of the moment alone unless that leaves it
/// free, when the best rotation nearest to `previous` is taken.
Eigen::Matrix3d cluster_rotation(const Eigen::Matrix3d& moment, const Eigen::Matrix3d& previous);

/// Whether a moment decides the `rotation` nearest to it.
bool is_determined(const Eigen::Matrix3d& rotation, const Eigen::Matrix3d& moment);

/// How a cluster's rotation follows its particles. The best fit leaves tr(RᵀA) = σ₀ + σ₁ + σ₂,
/// whose second derivative has the three twists of A as its only eigenmatrices, with eigenvalues 2
/// / (σᵢ + σⱼ): what the energy is softer by than with R held.
class ClusterTwists {
 public:
  /// `spread` Σ m q qᵀ of the rest offsets q. With kProjected the weights are cut so that they take
  /// away no more than the mass matrix gives.
  ClusterTwists(const Eigen::Matrix3d& moment, const Eigen::Matrix3d& spread,
                Definiteness definiteness);

  /// T_k, k = 0 to 2: between particles of unit mass with the rest offsets q and p the energy is
  /// softer by Σ_k (T_k q)(T_k p)ᵀ than with R held [1/(kg^½ m)].
  Eigen::Matrix3d turn(int k) const {
    return roots_(0, k) * twists_[0] + roots_(1, k) * twists_[1] + roots_(2, k) * twists_[2];
  }

 private:
  Eigen::Matrix3d twists_[3];  // orthonormal
  Eigen::Matrix3d roots_;      // a root of their weights, R Rᵀ
};

}  // namespace pliant
