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

  /// ∂/∂x of the three twist coordinates for a particle of unit mass with rest offset `rest`, as
  /// columns [m].
  Eigen::Matrix3d directions(const Eigen::Vector3d& rest) const;
  /// Symmetric [1/(kg m²)].
  const Eigen::Matrix3d& weights() const { return weights_; }

 private:
  Eigen::Matrix3d twists_[3];  // orthonormal
  Eigen::Matrix3d weights_;
};

}  // namespace pliant
