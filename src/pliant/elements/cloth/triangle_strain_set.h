#pragma once

#include "pliant/elements/cloth/membrane_law.h"
#include "pliant/elements/element_visitor.h"
#include "pliant/elements/solids/simplex_set.h"
#include "pliant/elements/yarn.h"
#include "pliant/geometry/mesh/triangle_mesh.h"

namespace pliant {

extern template class SimplexSet<MembraneLaw>;  // compiled once, in triangle_strain_set.cpp

/// In-plane strain of triangles, orthotropic along warp and weft, E = A Ψ with A the rest area.
/// Every part is a squared distance, hence a projective energy. Yarns resist stretching and
/// compression alike; triangles do not mind turning inside out, which in space is no strain. A
/// yarn compressed to a point has no direction and exerts no force.
class TriangleStrainSet final : public SimplexSet<MembraneLaw>, public HasYarns {
 public:
  /// `warp`: for each triangle a vector at rest, 3 x m, of any length; its part in the triangle's
  /// plane is the warp direction, and weft lies at right angles to it. Throws InputError for a
  /// mesh that validate() refuses, a vector that is not finite or at right angles to its triangle,
  /// stiffnesses that are negative, not finite or all zero, or limits out of their range.
  TriangleStrainSet(const TriangleMesh& rest, const Eigen::Matrix3Xd& warp,
                    const MembraneMaterial& material);

  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }

  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;

  /// Stretches |a| along warp and |b| along weft, 2 x m in the mesh's order.
  Eigen::Matrix2Xd stretches(const Positions& x) const;

  /// Along warp and weft of each triangle.
  void add_yarns(std::vector<Yarn>& yarns) const override;
  void add_edges(std::vector<ClothEdge>& edges) const override;
  void add_strains(const Positions& x, Eigen::VectorXd& sum, Eigen::VectorXd& count) const override;

 protected:
  void* offer(const std::type_info& type) override { return offer_as<HasYarns>(this, type); }
};

}  // namespace pliant
