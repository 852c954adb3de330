#pragma once

#include "pliant/elements/cloth/stretch_limits.h"
#include "pliant/elements/solids/simplex_set.h"

namespace pliant {

/// Ψ = 1/2 |G - P(G)|², P the nearest matrix with all stretches within the limits.
struct StretchLimitLaw {
  static constexpr int kDimension = 3;
  StretchLimits limits;
  void stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  void energies(const Eigen::Matrix3d* g, int count, double* energy) const {
    energies_of_stresses(*this, g, count, energy);
  }
  Eigen::Matrix<double, 9, 9> tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const;
  Eigen::Vector3d bound() const { return Eigen::Vector3d::Ones(); }
};

extern template class SimplexSet<StretchLimitLaw>;  // compiled once, in strain_limit_set.cpp

/// Limits to the principal stretches of tetrahedra, E = 1/2 k v |G - P(G)|², P(G) the matrix
/// nearest to the deformation gradient with signed principal stretches within [min, max] (Bouaziz
/// et al. 2014, "Projective dynamics", sec. 5.1; Hernandez et al. 2013). Nothing is felt within the
/// limits; beyond them k acts like the modulus 2 μ. Inverted tetrahedra are pulled back.
class StrainLimitSet final : public SimplexSet<StretchLimitLaw> {
 public:
  /// `stiffness` k > 0 [Pa]; `first_particle` is vertex 0 of `rest`. Throws InputError for a
  /// stiffness that is not positive and finite, limits out of their range, or a mesh that
  /// validate() refuses.
  StrainLimitSet(const TetrahedralMesh& rest, double stiffness, const StretchLimits& limits,
                 int first_particle = 0);

  /// The largest |σ - 1| of all principal stretches, those of inverted tetrahedra negative.
  double largest_strain(const Positions& x) const;
};

}  // namespace pliant
