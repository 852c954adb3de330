#pragma once

#include "pliant/elements/cloth/bending_stencils.h"

namespace pliant {

/// Row r of a lower triangle begins here.
constexpr int row_of(int r) { return r * (r + 1) / 2; }

/// Pieces of bending that meet their constraints C = Σ w x, C = 0 at rest, one after the other
/// (Macklin et al. 2016): all components of a piece at once, with compliance 1,
///   Δλ = −(1 + h² W M⁻¹ Wᵀ)⁻¹ (C + λ).
/// By vector registers, with the same bits for any width of them.
struct BendingRelaxation {
  const BendingStencils& stencils;
  const double* factors;   ///< row_of(rows) numbers a piece: L D Lᵀ of the inverse above
  double* multipliers;     ///< λ, 3 a component [root of N m]
  const double* mobility;  ///< 1/m of each particle [1/kg]
  double dt2;              ///< h² [s²]
  double* positions;       ///< 3 a particle [m]

  /// Pieces [begin, end), no two of which share a particle if threads work on others.
  void relax(int begin, int end) const;
};

}  // namespace pliant
