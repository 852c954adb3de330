#pragma once

#include <Eigen/Core>

#include "pliant/core/system/element_set.h"

namespace pliant {

using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// G = U diag(σ) Vᵀ with proper rotations U and V and σ₀ ≥ σ₁ ≥ |σ₂|; σ₂ < 0 where G is inverted.
struct PrincipalStretches {
  Eigen::Matrix3d u;
  Eigen::Vector3d sigma;
  Eigen::Matrix3d v;

  /// U diag(p) Vᵀ.
  Eigen::Matrix3d compose(const Eigen::Vector3d& p) const {
    return u * p.asDiagonal() * v.transpose();
  }
};

/// For any matrix; NaN stretches where it is not finite.
PrincipalStretches principal_stretches(const Eigen::Matrix3d& g);

/// Derivative of an isotropic map of matrices, P(G) = U diag(p(σ)) Vᵀ. Entry k of `flip` and
/// `twist` belongs to the pair of stretches (i, j) that leaves out k.
struct StretchSlope {
  Eigen::Matrix3d stretch;  ///< ∂pᵢ/∂σₖ
  Eigen::Vector3d flip;     ///< (pᵢ - pⱼ) / (σᵢ - σⱼ), or its limit
  Eigen::Vector3d twist;    ///< (pᵢ + pⱼ) / (σᵢ + σⱼ)
};

/// The twist slopes of `p`. They grow without bound where σᵢ + σⱼ vanishes, where the rotations
/// become ambiguous and P jumps: cut at 1e12.
Eigen::Vector3d twist_slopes(const Eigen::Vector3d& sigma, const Eigen::Vector3d& p);

/// I - dP/dG, the Hessian of 1/2 |G - P(G)|² with P(G) the nearest matrix of some set, over G's
/// entries column by column. Its eigenmatrices are known (Smith, De Goes and Kim 2019, "Analytic
/// eigensystems for isotropic distortion energies", sec. 4): U T Vᵀ with T diagonal (three
/// stretches), symmetric (three flips) or antisymmetric (three twists). With kProjected the
/// negative eigenvalues are zero instead.
Matrix9d distance_tangent(const PrincipalStretches& g, const StretchSlope& slope,
                          Definiteness definiteness);

}  // namespace pliant
