#pragma once

#include "pliant/laws/sph_kernels.h"

/// What a particle of liquid and its neighbours do to each other (docs/viscoelastic.md).
namespace pliant {

/// ψ, the density over that of rest, from Σ V W of spiky, the particle's own share included.
template <typename T>
PLIANT_HOST_DEVICE inline T sph_filling(T sum) {
  return greater(T(0), T(1) + (sum - T(kSphBulk)) / T(kSphSlope));
}

/// p/ψ² [Pa] with the bulk modulus c² ρ⁰ [Pa]: liquid presses, and does not pull.
template <typename T>
PLIANT_HOST_DEVICE inline T sph_pressure(T bulk, T psi) {
  return psi > T(1) ? bulk * (psi - T(1)) / (psi * psi) : T(0);
}

/// What the forces of a pair count for, by how much of each is liquid: all of them between bodies
/// or materials.
template <typename T>
PLIANT_HOST_DEVICE inline T sph_pair_weight(T beta, T other_beta, bool is_alike) {
  const T larger = greater(beta, other_beta);
  return is_alike ? larger : T(1);
}

/// The mean viscosity of a pair, for sums of ∇²W that pass integrals [Pa s].
template <typename T>
PLIANT_HOST_DEVICE inline T sph_pair_viscosity(T viscosity, T other_viscosity) {
  return T(0.5) / T(kSphLaplacian) * (viscosity + other_viscosity);
}

/// The pressure force on a particle is −this times the offset from its neighbour at distance `r`,
/// where `pressures` is the sum of both p/ψ² and `volumes` w Vᵢ Vⱼ. Coincident particles have no
/// direction to leave in: their offset is 0.
template <typename T>
PLIANT_HOST_DEVICE inline T sph_pull(const SphKernels<T>& kernels, T volumes, T pressures, T r) {
  const T slope = kernels.spiky_slope(r) / (r > T(0) ? r : T(1));
  return volumes * pressures * (slope / T(kSphSlope));
}

/// And the viscous force is −this times its velocity against the neighbour's [kg/s].
template <typename T>
PLIANT_HOST_DEVICE inline T sph_drag(const SphKernels<T>& kernels, T volumes, T viscosity, T r) {
  return volumes * viscosity * kernels.viscosity_laplacian(r);
}

/// What XSPH mixes of a pair's velocities, but for W: equal for both, whatever their sizes.
template <typename T>
PLIANT_HOST_DEVICE inline T xsph_weight(T beta, T other_beta, T mass, T other_mass, T volume,
                                        T other_volume) {
  return lesser(beta, other_beta) * lesser(mass, other_mass) * lesser(volume, other_volume);
}

/// Attraction of a pair over the factor A: the force on a particle is A times this times the offset
/// from its neighbour. `squared` is that of the distance.
template <typename T>
PLIANT_HOST_DEVICE inline T cohesion_slope(const SphKernels<T>& kernels, T beta, T other_beta,
                                           T volume, T other_volume, T squared) {
  return lesser(beta, other_beta) * (volume * other_volume) * kernels.poly6_slope(squared);
}

}  // namespace pliant
