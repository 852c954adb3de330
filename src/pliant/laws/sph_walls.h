#pragma once

#include "pliant/laws/sph_kernels.h"

/// Walls as a liquid feels them, at `distance` from a particle.
namespace pliant {

/// What a wall fills is so many times ∫W over the half space, moved back by a share of the support.
/// These two make the first layer of particles, half a spacing from the wall, as full as bulk
/// liquid, and the wall's force on the layers the pressure.
constexpr double kWallGain = 7.63;
constexpr double kWallSetBack = 0.2813;
constexpr double kWallMostFilled = 0.98;
/// A share of the support: nearer particles are dragged as if they were so far away.
constexpr double kWallNearestDrag = 0.125;

/// Its part of Σ V W.
template <typename T>
PLIANT_HOST_DEVICE inline T wall_filling(const SphKernels<T>& kernels, T distance) {
  const T beyond = distance + T(kWallSetBack) * kernels.support();
  return lesser(T(kWallMostFilled), T(kWallGain) * kernels.spiky_beyond(beyond));
}

/// Force along the normal on the volume `volume`, of which other walls leave so much, under the
/// pressure `bulk` (ψ − 1).
template <typename T>
PLIANT_HOST_DEVICE inline T wall_push(const SphKernels<T>& kernels, T volume, T bulk, T psi,
                                      T distance) {
  const T pressure = psi > T(1) ? bulk * (psi - T(1)) : T(0);
  return volume * pressure / (T(kSphSlope) * greater(T(1), psi * psi)) * T(kWallGain) *
         kernels.spiky_push_beyond(distance + T(kWallSetBack) * kernels.support());
}

/// Of a particle that slips along it: force over velocity.
template <typename T>
PLIANT_HOST_DEVICE inline T wall_drag(const SphKernels<T>& kernels, T volume, T viscosity,
                                      T distance) {
  const T nearest = T(kWallNearestDrag) * kernels.support();
  return volume * viscosity / T(kSphLaplacian) *
         kernels.viscosity_drag_beyond(greater(nearest, distance));
}

}  // namespace pliant
