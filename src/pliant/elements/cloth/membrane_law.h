#pragma once

#include <string>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/cloth/stretch_limits.h"
#include "pliant/elements/solids/simplex.h"

namespace pliant {

/// Woven or knitted stuff in its plane, as it behaves at small strains: no Poisson effect between
/// warp and weft. All are per length of an edge across the force.
struct MembraneMaterial {
  double warp = 0.0;   ///< >= 0 [N/m]
  double weft = 0.0;   ///< >= 0 [N/m]
  double shear = 0.0;  ///< >= 0, force over shear angle [N/m]
  double limit = 0.0;  ///< added to warp and weft beyond the limits, >= 0 [N/m]
  StretchLimits warp_limits;
  StretchLimits weft_limits;
};

/// Throws InputError, beginning with `name`, for stiffnesses that are negative, not finite or all
/// zero, or limits out of their range.
void check(const std::string& name, const MembraneMaterial& material);

/// With a = G w and b = G t what warp and weft (unit vectors at rest) become:
///   Ψ = 1/2 k_w (|a| - 1)² + 1/2 k_t (|b| - 1)² + 1/2 k_s (|a + b| - |a - b|)² / 2
///       + 1/2 k_l [(|a| - c(|a|))² + (|b| - c(|b|))²], c(.) clamped to the limits.
/// The third term is k_s times the squared distance to the nearest pair of vectors at right angles:
/// half the difference of the diagonals' lengths is the shear angle γ / √2 for small ones.
struct MembraneLaw {
  static constexpr int kDimension = 2;
  MembraneMaterial material;
  void stresses(const Gradient<2>* g, int count, Gradient<2>* p) const;
  void energies(const Gradient<2>* g, int count, double* energy) const;
  Eigen::Matrix<double, 6, 6> tangent(const Gradient<2>& g, Definiteness definiteness) const;
  Eigen::Vector2d bound() const;
};

}  // namespace pliant
