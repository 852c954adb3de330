#pragma once

#include <string>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/element_visitor.h"
#include "pliant/elements/yarn.h"

namespace pliant {

struct Spring {
  int i = 0;
  int j = 0;
  double rest_length = 0.0;  ///< [m]
  double stiffness = 0.0;    ///< [N/m]
};

/// Linear springs, E = 1/2 k (|x_i - x_j| - l)^2.
class SpringSet final : public ElementSet, public HasYarns {
 public:
  /// Throws InputError for a rest length or stiffness that is not positive and finite, or a
  /// particle out of range.
  SpringSet(std::string name, const std::vector<Spring>& springs, int particles);

  std::string_view name() const override { return name_; }
  int size() const override { return static_cast<int>(springs_.size()); }
  Cost cost_of_element() const override { return Cost::kSpring; }
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

  /// (length - rest length) / rest length of every spring, in the set's own order.
  Eigen::VectorXd strains(const Positions& x) const;
  /// Colour by colour.
  const std::vector<Spring>& springs() const { return springs_; }
  /// Adds each spring's strain to both of its particles in `sum`, and 1 to them in `count`.
  void add_strains(const Positions& x, Eigen::VectorXd& sum, Eigen::VectorXd& count) const override;
  void add_yarns(std::vector<Yarn>& yarns) const override;
  void add_edges(std::vector<ClothEdge>& edges) const override;

 protected:
  /// Its springs are yarns where they are named `stretch`.
  void* offer(const std::type_info& type) override {
    return name_ == "stretch" ? offer_as<HasYarns>(this, type) : nullptr;
  }

 private:
  std::string name_;
  std::vector<Spring> springs_;  // colour by colour
  std::vector<int> begins_;
  std::vector<double> multipliers_;  // [N]
};

}  // namespace pliant
