#pragma once

#include <vector>

#include "pliant/core/element_set.h"
#include "pliant/elements/bending_stencils.h"

namespace pliant {

/// Quadratic bending of sheets whose rest state is flat, E = 1/2 Σ_e k_e |Σ_k w_k x_k|²: thin
/// plates that bend without stretching (Bergou et al. 2006, "A quadratic bending model for
/// inextensible surfaces"), on grids and on meshes (bending_stencils.h).
class BendingSet final : public ElementSet {
 public:
  /// Throws InputError for a stiffness that is not positive and finite [N m].
  BendingSet(const TriangleMesh& rest, double stiffness);
  /// `warp`: a direction whose part in each triangle's plane is warp there.
  BendingSet(const TriangleMesh& rest, const Eigen::Vector3d& warp, double warp_stiffness,
             double weft_stiffness);
  /// Warp lies along the rows.
  BendingSet(const GridOptions& grid, double warp_stiffness, double weft_stiffness);

  std::string_view name() const override { return "bending"; }
  int size() const override { return stencils_.size(); }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

  /// The constant stiffness: the force on i is Σ_j value (x_j - x_i) over what row i has [N/m].
  struct Rows {
    std::vector<int> begins = {0};
    std::vector<int> columns;
    std::vector<double> values;
  };
  const Rows& rows() const { return rows_; }

 private:
  BendingSet(const BendingStencils& stencils, int particles);
  void color(const BendingStencils& stencils, int particles);
  void add_up(int particles);
  template <int R>
  void find_responses(const Eigen::VectorXd& inverse_mass, double dt2);
  template <int R>
  void relax_all(const Eigen::VectorXd& inverse_mass, double dt2, Positions& x);

  /// What relax() makes of masses and time step, which seldom change: for each component of a piece
  /// how it answers the multipliers of those before it, and 1 / (1 + its own answer).
  struct Responses {
    Eigen::VectorXd inverse_mass;
    double dt2 = 0.0;
    std::vector<double> values;
  };

  BendingStencils stencils_;  // colour by colour
  std::vector<int> begins_;
  Rows rows_;
  Responses responses_;
  std::vector<double> multipliers_;  // 3 a component [root of N m]
};

}  // namespace pliant
