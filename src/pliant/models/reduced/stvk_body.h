#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "pliant/elements/elastic_material.h"
#include "pliant/geometry/tetrahedral_mesh.h"

namespace pliant {

/// St. Venant-Kirchhoff tetrahedra with linear shape functions (Barbič and James 2005, "Real-time
/// subspace integration for St. Venant-Kirchhoff deformable models"):
///   W = Σₑ vₑ (μ E:E + λ/2 tr(E)²),  E = ½ (∇u + ∇uᵀ + ∇uᵀ∇u),
/// a quartic polynomial of the displacements u. Vectors of displacements and forces hold the free
/// vertices only, x y z of one after the other: size() numbers [m, N].
///
/// The material softens under compression: beyond 1/√3 = 0.577 of the rest length its force falls
/// again, and it may collapse.
class StvkBody {
 public:
  /// Throws InputError, its message beginning with `where`, for a mesh that validate() refuses, a
  /// material out of its range (young > 0, -1 < poisson < 0.5, density > 0), or a fixed vertex that
  /// is out of range; also when no vertex is free.
  StvkBody(TetrahedralMesh mesh, const ElasticMaterial& material, const std::vector<int>& fixed,
           const std::string& where);

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
  /// ∇u of each tetrahedron, 3 x 3 m.
  Eigen::MatrixXd gradients(const Eigen::VectorXd& u) const;
  /// Second Piola-Kirchhoff stress 2 μ E + λ tr(E) I [Pa].
  Eigen::Matrix3d stress(const Eigen::Matrix3d& strain) const;
  double rest_volume(int tetrahedron) const { return volumes_[tetrahedron]; }  ///< [m³]

 private:
  /// Adds v P gₐ of tetrahedron t to its free vertices.
  void scatter(int t, const Eigen::Matrix3d& p, Eigen::VectorXd& r) const;
  Eigen::Matrix3d gradient(int t, const Eigen::VectorXd& u) const;

  TetrahedralMesh mesh_;
  ElasticMaterial material_;
  double mu_ = 0.0, lambda_ = 0.0;  // Lamé parameters [Pa]
  std::vector<int> index_;
  int size_ = 0;
  Eigen::VectorXd volumes_;
  std::vector<Eigen::Matrix<double, 3, 4>> shapes_;  // gradients of the shape functions [1/m]
};

}  // namespace pliant
