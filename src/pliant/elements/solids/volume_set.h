#pragma once

#include "pliant/elements/solids/simplex_set.h"

namespace pliant {

/// Volumes that cost no energy, relative to the rest volume.
struct VolumeLimits {
  double min = 1.0;  ///< > 0
  double max = 1.0;  ///< >= min
};

/// |V/V₀ - 1| of tetrahedra with the volume V₀ at rest.
struct VolumeError {
  double largest = 0.0;
  double mean = 0.0;  ///< of all tetrahedra, each counted alike
};

/// Ψ = 1/2 |G - P(G)|², P the nearest matrix whose determinant lies within the limits.
struct NearestVolumeLaw {
  static constexpr int kDimension = 3;
  VolumeLimits limits;
  void stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  void energies(const Eigen::Matrix3d* g, int count, double* energy) const {
    energies_of_stresses(*this, g, count, energy);
  }
  Eigen::Matrix<double, 9, 9> tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const;
  Eigen::Vector3d bound() const { return Eigen::Vector3d::Ones(); }
};

extern template class SimplexSet<NearestVolumeLaw>;  // compiled once, in volume_set.cpp

/// Volume preservation of tetrahedra, E = 1/2 κ v |G - P(G)|², P(G) the matrix nearest to the
/// deformation gradient with det P = 1, or within limits (Bouaziz et al. 2014, "Projective
/// dynamics", sec. 5.1). P is the true nearest matrix, found to round-off. For small strains ε that
/// is 1/2 v (κ/3) tr(ε)²: the Lamé parameter λ is κ/3, and shear costs nothing. With TetrahedronSet
/// it makes a material of any Poisson's ratio in (0, 0.5), see elastic_material.h; near 0.5 linear
/// tetrahedra lock: they bend too stiffly, the more the coarser the mesh.
///
/// Flat and inverted tetrahedra are pulled back. Where a volume has to shrink by a factor of 7 or
/// more the nearest matrix flattens one axis instead of all three, and the force jumps.
class VolumeSet final : public SimplexSet<NearestVolumeLaw> {
 public:
  /// `stiffness` κ > 0 [Pa]; `first_particle` is vertex 0 of `rest`. Throws InputError for a
  /// stiffness that is not positive and finite, limits out of their range, or a mesh that
  /// validate() refuses.
  VolumeSet(const TetrahedralMesh& rest, double stiffness, const VolumeLimits& limits = {},
            int first_particle = 0);
  /// One stiffness a tetrahedron.
  VolumeSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
            const VolumeLimits& limits = {}, int first_particle = 0);

  VolumeError error(const Positions& x) const;
};

}  // namespace pliant
