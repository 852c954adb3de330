#pragma once

#include "pliant/elements/element_visitor.h"
#include "pliant/elements/solids/elastic_material.h"
#include "pliant/elements/solids/simplex_set.h"

namespace pliant {

/// Ψ = |G - R|² + ρ/2 (R : G - 3)², R the rotation nearest to G.
struct CorotatedLaw {
  static constexpr int kDimension = 3;
  double ratio = 0.0;  ///< ρ = λ/μ >= 0
  void stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  void energies(const Eigen::Matrix3d* g, int count, double* energy) const;
  Eigen::Vector3d bound() const { return Eigen::Vector3d::Constant(2.0 + 3.0 * ratio); }
};

/// Without the tangent: its eigenmatrices take vertices to few directions.
void find_vertex_blocks(const CorotatedLaw& law, const Simplex<3>& s, const Eigen::Matrix3d& g,
                        Definiteness definiteness, VertexBlocks<3>& blocks);
void find_vertex_blocks(const CorotatedLaw& law, const Simplex<3>* simplices,
                        const Eigen::Matrix3d* g, int count, Definiteness definiteness,
                        VertexBlocks<3>* blocks);

extern template class SimplexSet<CorotatedLaw>;  // compiled once, in tetrahedron_set.cpp

/// Corotated (as-rigid-as-possible) tetrahedra, E = s v |G - R|², with v the rest volume, G the
/// deformation gradient and R the rotation nearest to it (Fratarcangeli et al. 2018, "Parallel
/// iterative solvers for real-time elastic deformations"; Chao et al. 2010). For small strains ε
/// that is s v |ε|²: the Lamé parameters are μ = s and λ = 0, so Poisson's ratio is 0 and Young's
/// modulus 2 s. A second Lamé parameter adds 1/2 λ v (R : G - 3)², any other Poisson's ratio for no
/// more than the same rotation (corotated linear elasticity, Müller and Gross 2004). That resists
/// the sum of the stretches, not their product: VolumeSet keeps volumes under large strains.
/// ElasticMaterial (elastic_material.h) knows both parameters from Young's modulus and Poisson's
/// ratio. In the stretches both terms are convex: one tetrahedron has no minimum but its rest
/// shape.
///
/// Flat and inverted tetrahedra are pulled back: R is proper, and forces are finite, for every G.
/// Where the two smallest stretches cancel (a tetrahedron inverted as far along one axis as it is
/// stretched along another, or collapsed to a line) R is ambiguous and the force jumps.
class TetrahedronSet final : public SimplexSet<CorotatedLaw> {
 public:
  /// `stiffness` s > 0 [Pa]; `first_particle` is vertex 0 of `rest`. Throws InputError for a
  /// stiffness that is not positive and finite, or a mesh that validate() refuses.
  TetrahedronSet(const TetrahedralMesh& rest, double stiffness, int first_particle = 0);

  bool is_solid() const override { return true; }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }
  /// μ > 0 and λ >= 0 of `lame`; throws InputError likewise.
  TetrahedronSet(const TetrahedralMesh& rest, const LameParameters& lame, int first_particle = 0);
  /// One stiffness a tetrahedron.
  TetrahedronSet(const TetrahedralMesh& rest, const Eigen::VectorXd& stiffness,
                 int first_particle = 0);

  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;
};

}  // namespace pliant
