#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "pliant/elements/solids/elastic_material.h"
#include "pliant/elements/solids/gradient_stencils.h"
#include "pliant/geometry/mesh/tetrahedral_mesh.h"

namespace pliant {

/// St. Venant-Kirchhoff tetrahedra with linear shape functions (Barbič and James 2005, "Real-time
/// subspace integration for St. Venant-Kirchhoff deformable models"):
///   W = Σₑ vₑ (μ E:E + λ/2 tr(E)²),  E = ½ (∇u + ∇uᵀ + ∇uᵀ∇u),
/// a quartic polynomial of the displacements u. Vectors of displacements and forces hold the free
/// vertices only, x y z of one after the other: size() numbers [m, N].
///
/// Where strains are averaged, the term with μ is that of the mean strain around each edge and the
/// one with λ that around each free vertex (averaged_tetrahedra.h), which does not lock near
/// Poisson's ratio 0.5. A "part" has one ∇u: a tetrahedron, or what belongs to an edge or a vertex.
///
/// The material softens under compression: beyond 1/√3 = 0.577 of the rest length its force falls
/// again, and it may collapse.
class StvkBody {
 public:
  /// Throws InputError, its message beginning with `where`, for a mesh that validate() refuses, a
  /// material out of its range (young > 0, -1 < poisson < 0.5, density > 0), or a fixed vertex that
  /// is out of range; also when no vertex is free.
  StvkBody(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& fixed,
           const std::string& where, bool averaged = false);

  const TetrahedralMesh& mesh() const { return mesh_; }
  const ElasticMaterial& material() const { return material_; }
  int size() const { return size_; }
  /// The first of a vertex's three numbers; -1 when it is fixed.
  int index(int vertex) const { return index_[static_cast<std::size_t>(vertex)]; }
  /// A fixed vertex's rows are 0: 3n x columns of columns over the free vertices.
  Eigen::MatrixXd expand(const Eigen::MatrixXd& free) const;

  double energy(const Eigen::VectorXd& u) const;           ///< [J]
  Eigen::VectorXd forces(const Eigen::VectorXd& u) const;  ///< R(u) = ∂W/∂u [N]
  Eigen::SparseMatrix<double> rest_stiffness() const;      ///< K(0) [N/m]
  /// H[a, b] = ∂²R/∂u² at rest applied to a and b: what is quadratic in R(u) is ½ H[u, u] [N].
  Eigen::VectorXd second_derivative(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;
  /// ∫ ρ φₐ φ_b: of linear tetrahedra (ρ v/20)(1 + δₐ_b) [kg].
  Eigen::SparseMatrix<double> consistent_mass() const;
  /// A quarter of its tetrahedra's masses on each vertex [kg].
  Eigen::SparseMatrix<double> lumped_mass() const;
  int parts() const { return parts_.size(); }
  /// ∇u of each part, 3 x 3 parts.
  Eigen::MatrixXd gradients(const Eigen::VectorXd& u) const;
  /// λ and μ of a part's energy; one of them may be 0.
  const LameParameters& lame(int part) const { return lame_[static_cast<std::size_t>(part)]; }
  /// Second Piola-Kirchhoff stress 2 μ E + λ tr(E) I of a part [Pa].
  Eigen::Matrix3d stress(int part, const Eigen::Matrix3d& strain) const;
  double rest_volume(int part) const { return parts_.volume(part); }  ///< [m³]

 private:
  /// Adds v P gₐ of a part to its free vertices.
  void scatter(int part, const Eigen::Matrix3d& p, Eigen::VectorXd& r) const;
  Eigen::Matrix3d gradient(int part, const Eigen::VectorXd& u) const;

  TetrahedralMesh mesh_;
  ElasticMaterial material_;
  std::vector<int> index_;
  int size_ = 0;
  Eigen::VectorXd volumes_;  // of the tetrahedra [m³]
  GradientStencils parts_;
  std::vector<LameParameters> lame_;  // of the parts
};

}  // namespace pliant
