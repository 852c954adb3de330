#pragma once

#include <Eigen/Core>

#include "pliant/elements/solids/principal_stretches.h"

namespace pliant {

/// The stretches nearest to σ whose product is `volume`: pᵢ = σᵢ + μ/pᵢ.
struct VolumeProjection {
  Eigen::Vector3d p;
  double mu = 0.0;  ///< positive where the element has to grow

  double squared_distance() const { return mu * mu * p.cwiseInverse().squaredNorm(); }
};

/// Nearest of all p with p₀ p₁ p₂ = `volume` > 0, for signed stretches σ₀ ≥ σ₁ ≥ |σ₂| of any size.
/// Where the volume has to shrink by a factor of about 7 or more, that is no longer a near-uniform
/// shrinking but a flattening along the axis of σ₂: the nearest point jumps there.
VolumeProjection project_to_volume(const Eigen::Vector3d& sigma, double volume);

/// The derivative of that projection.
StretchSlope volume_slope(const Eigen::Vector3d& sigma, const VolumeProjection& projection);

}  // namespace pliant
