#pragma once

#include <array>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/element_visitor.h"
#include "pliant/geometry/mesh/grid.h"

namespace pliant {

/// Quadratic bending: of meshes over the hinge of each inner edge, E = 1/2 B 1/(A_0+A_1) |sum_k K_k
/// x_k|^2, with cotangent weights K of the flat rest state (Bergou et al. 2006, "A quadratic
/// bending model for inextensible surfaces", eqs. 3-4). Their factor 3 is left out: with it a sheet
/// rolled to curvature kappa stores three times the thin plate's 1/2 B kappa² A; without it that
/// energy comes out along the warp and weft of a grid, and in every direction of an equilateral
/// mesh. The rest state is flat.
class BendingSet final : public ElementSet {
 public:
  /// `stiffness` B > 0 [N m].
  BendingSet(const TriangleMesh& rest, double stiffness);
  /// Orthotropic: B = B_warp^c B_weft^(1 - c), c the squared cosine of the angle between warp and
  /// the direction that a hinge bends. So the hinges of a grid's diagonals, which feel twist alone,
  /// have √(B_warp B_weft), as Huber 1923 has it for orthotropic plates. The warp of each triangle
  /// is the part of `warp` in its plane; both stiffnesses > 0 [N m].
  BendingSet(const TriangleMesh& rest, const Eigen::Vector3d& warp, double warp_stiffness,
             double weft_stiffness);

  /// A grid's own: second differences along its rows (warp) and columns (weft) at every inner
  /// vertex of them, and the twist of each cell with √(B_warp B_weft), which is the orthotropic
  /// plate
  ///   E = 1/2 ∫ B_warp κ_x² + B_weft κ_y² + 2 √(B_warp B_weft) κ_xy².
  /// Hinges would not do: with diagonals that alternate they feel no bending of a row at every
  /// second vertex, which narrow strips yield to by a fifth and more. Both stiffnesses > 0 [N m].
  BendingSet(const GridOptions& grid, double warp_stiffness, double weft_stiffness);

  std::string_view name() const override { return "bending"; }
  int size() const override { return static_cast<int>(hinges_.size()); }
  Cost cost_of_element() const override { return Cost::kHinge; }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  /// Of the edge, then opposite to it; of a grid: of the difference.
  struct Hinge {
    std::array<int, 4> vertices;
    std::array<double, 4> weights;
    double stiffness = 0.0;  ///< B/(A_0+A_1); of a grid as its differences need it [N/m]
  };
  /// Colour by colour.
  const std::vector<Hinge>& hinges() const { return hinges_; }

 private:
  void color(const std::vector<Hinge>& hinges, int particles);
  static Eigen::Vector3d curvature(const Hinge& hinge, const Positions& x);

  std::vector<Hinge> hinges_;  // colour by colour
  std::vector<int> begins_;
  Positions multipliers_;  // 3 x hinges [N]
};

}  // namespace pliant
