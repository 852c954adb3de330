#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/cloth/bending_hinges.h"
#include "pliant/elements/cloth/bending_stencils.h"
#include "pliant/elements/cloth/bending_sums.h"
#include "pliant/elements/element_visitor.h"
#include "pliant/elements/solids/strain_damping_set.h"

namespace pliant {

/// Quadratic bending of sheets whose rest state is flat, E = 1/2 Σ_e k_e |Σ_k w_k x_k|²: thin
/// plates that bend without stretching (Bergou et al. 2006, "A quadratic bending model for
/// inextensible surfaces"). Of a grid the orthotropic plate's
///   E = 1/2 ∫ B_warp κ_x² + B_weft κ_y² + 2 √(B_warp B_weft) κ_xy²
/// (bending_hinges.h), of a mesh hinges, or plates, which converge to it on any mesh
/// (bending_stencils.h).
class BendingSet final : public ElementSet {
 public:
  /// Hinges. All throw InputError for a stiffness that is not positive and finite [N m].
  BendingSet(const TriangleMesh& rest, double stiffness);
  /// `warp`: a direction whose part in each triangle's plane is warp there.
  BendingSet(const TriangleMesh& rest, const Eigen::Vector3d& warp, double warp_stiffness,
             double weft_stiffness);
  /// Warp lies along the rows. `to_edges`: as hinges_of_grid().
  BendingSet(const GridOptions& grid, double warp_stiffness, double weft_stiffness,
             bool to_edges = true);
  static std::unique_ptr<BendingSet> plates(const TriangleMesh& rest, const Eigen::Vector3d& warp,
                                            double warp_stiffness, double weft_stiffness);

  std::string_view name() const override { return "bending"; }
  int size() const override { return stencils_.size(); }
  double work() const override;
  Cost cost_of_element() const override { return Cost::kHinge; }
  bool accept(ElementVisitor& visitor) const override {
    visitor.see(*this);
    return true;
  }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  /// Of pairs that lie further apart than the two corners beside an edge, those that would push
  /// each other apart are left out, and those that would pull each other do so by way of the
  /// particles between them: that is stiffer, and no matrix has more entries for it.
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  const BendingRows& rows() const { return rows_; }

 private:
  BendingSet(BendingStencils stencils, int particles);
  void color(BendingStencils stencils, int particles);
  void add_up(int particles);
  /// What vertex number `own` of piece e, particle i, adds to its row.
  void add_entries(int i, int e, int own, std::vector<std::pair<int, double>>& entries) const;
  bool is_near(std::size_t entry) const { return is_near_.empty() || is_near_[entry]; }
  void add_far_pairs(SystemMatrix& a) const;
  std::vector<int> near_to_both(int i, int j) const;
  void find_near(const std::vector<BendingHinge>& hinges);
  std::vector<StrainMeasure> strains_of_grid() const;
  std::vector<StrainMeasure> strains_of_hinges() const;
  std::vector<StrainMeasure> strains_of_triangles() const;
  template <int R>
  void find_factors(const Eigen::VectorXd& inverse_mass, double dt2);

  /// Of 1 + h² W M⁻¹ Wᵀ of each piece: masses and time step seldom change.
  struct Factors {
    Eigen::VectorXd inverse_mass;
    double dt2 = 0.0;
    std::vector<double> values;
  };

  BendingStencils stencils_;  // colour by colour
  std::vector<int> begins_;
  BendingRows rows_;
  std::vector<bool> is_near_;        // of each entry of rows_; empty: all are
  std::optional<GridOptions> grid_;  // none: it is a mesh
  BendingStiffness grid_stiffness_;
  bool to_edges_ = true;
  Factors factors_;
  std::vector<double> multipliers_;  // 3 a component [root of N m]
};

}  // namespace pliant
