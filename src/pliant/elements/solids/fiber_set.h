#pragma once

#include "pliant/elements/element_visitor.h"
#include "pliant/elements/solids/simplex_set.h"

namespace pliant {

/// Ψ = 1/2 (|g₀| - 1)², g₀ the first column of G: the fibre lies along the first rest axis.
struct FiberLaw {
  static constexpr int kDimension = 3;
  void stresses(const Eigen::Matrix3d* g, int count, Eigen::Matrix3d* p) const;
  void energies(const Eigen::Matrix3d* g, int count, double* energy) const {
    energies_of_stresses(*this, g, count, energy);
  }
  Eigen::Matrix<double, 9, 9> tangent(const Eigen::Matrix3d& g, Definiteness definiteness) const;
  Eigen::Vector3d bound() const { return Eigen::Vector3d::UnitX(); }
};

extern template class SimplexSet<FiberLaw>;  // compiled once, in fiber_set.cpp

/// Fibres that run through tetrahedra in one direction, E = 1/2 k v (|G a| - 1)², with v the rest
/// volume, G the deformation gradient and a the unit vector along the fibres at rest. They resist
/// stretch and compression, and turn with the body at no cost. To a material of Young's modulus E
/// and Poisson's ratio 0 they add k along a: E + k there, E across.
///
/// Every state has finite forces. A fibre that is pressed to a point springs back along the normal
/// of what lies across it, or else along x.
class FiberSet final : public SimplexSet<FiberLaw> {
 public:
  /// `stiffness` k > 0 [Pa]; `direction` of any length but 0, in the rest frame of the mesh;
  /// `first_particle` is vertex 0 of `rest`. Throws InputError for a stiffness that is not positive
  /// and finite, a direction that is zero or not finite, or a mesh that validate() refuses.
  FiberSet(const TetrahedralMesh& rest, double stiffness, const Eigen::Vector3d& direction,
           int first_particle = 0);

  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }

  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;
};

}  // namespace pliant
