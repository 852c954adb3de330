#pragma once

#include <array>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/element_visitor.h"

namespace pliant {

/// A cell of a grid, its corners one after the other around it: its diagonals join 0 and 2, and 1
/// and 3.
struct ShearCell {
  std::array<int, 4> corners = {};
  double stiffness = 0.0;  ///< k [N/m]
};

/// Shear of the cells of a grid, apart from their stretch: E = 1/2 k (|d| - |e|)² with the two
/// diagonals d and e of each cell. Stretched along its sides a rectangle's diagonals stay as long
/// as each other, so that what stretches them together costs nothing; springs along them would make
/// cloth stiffer along warp and weft as well. A diagonal without length exerts no force.
class CellShearSet final : public ElementSet {
 public:
  /// Throws InputError for a stiffness that is not positive and finite, a particle out of range, or
  /// one that a cell has twice.
  CellShearSet(const std::vector<ShearCell>& cells, int particles);

  std::string_view name() const override { return "shear"; }
  int size() const override { return static_cast<int>(cells_.size()); }
  Cost cost_of_element() const override { return Cost::kCell; }
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

  /// Colour by colour.
  const std::vector<ShearCell>& cells() const { return cells_; }

 private:
  std::vector<ShearCell> cells_;  // colour by colour
  std::vector<int> begins_;
  std::vector<double> multipliers_;  // [N]
};

}  // namespace pliant
