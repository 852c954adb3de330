#pragma once

#include "pliant/core/system/neighbor_lists.h"
#include "pliant/laws/sph_kernels.h"

namespace pliant {

/// What a particle of a liquid is to its neighbours' sums: three registers of four numbers.
struct alignas(32) LiquidParticle {
  double x[3], volume;
  double v[3], pressure;               ///< p/ψ² [Pa]
  double viscosity, beta, part, none;  ///< part: its number; none: unused
};

/// Sums over the neighbours of particles, in order and by vector registers: the same bits for any
/// width of them. `particles` and results are by rank of the `lists`, for those in [begin, end).
struct LiquidSums {
  const NeighborLists& lists;
  const LiquidParticle* particles;
  SphKernels<double> kernels;

  /// Σ V W of each particle, its own share included.
  void fill(int begin, int end, double* sums) const;
  /// Forces of pressure and viscosity [N], 3 numbers each.
  void push(int begin, int end, double* forces) const;
  /// Σ d (vᵢ − vⱼ)·(vᵢ − vⱼ + v'ᵢ − v'ⱼ) [W] with the drag d of push() and other velocities v'
  /// [m/s], 4 numbers each.
  void lose(int begin, int end, const double* others, double* losses) const;
};

}  // namespace pliant
