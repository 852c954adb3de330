#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pliant/core/system/element_set.h"
#include "pliant/elements/cloth/stretch_laws.h"
#include "pliant/elements/solids/gradient_stencils.h"
#include "pliant/elements/solids/leaves_out_pinned.h"

namespace pliant {

/// Where a set of parts has its deformation gradients, and tetrahedra whose matrix bounds its own:
/// a mean's squared distance is at most the mean of its tetrahedra's, and their matrix has far
/// fewer entries.
struct StencilPlaces {
  std::shared_ptr<const GradientStencils> parts;
  std::shared_ptr<const GradientStencils> bound;  ///< the same, where parts are tetrahedra
};

/// E = Σ stiffness volume Ψ(G) over parts of a body. `Law` is ShearLaw or PressureLaw; the parts of
/// pressures, vertices, leave out those that are pinned.
template <class Law>
class StencilSet : public ElementSet, public LeavesOutPinned {
 public:
  /// `stiffness` > 0 [Pa].
  StencilSet(std::string name, StencilPlaces places, double stiffness);

  std::string_view name() const override { return name_; }
  int size() const override { return parts().size(); }
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  double work() const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void add_damping(double time, std::vector<std::unique_ptr<ElementSet>>& sets) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;
  bool leave_out_pinned(const Particles& particles) override;

 protected:
  void* offer(const std::type_info& type) override;
  const GradientStencils& parts() const { return *places_.parts; }
  Law& law() { return law_; }
  /// Of all, times the stiffness that it was made with.
  void set_scale(double scale) { scale_ = scale; }

 private:
  static constexpr int kGrain = 32, kSumGrain = 256;

  double weight(int part) const { return scale_ * stiffness_ * parts().volume(part); }
  /// Calls use(part, G, stress) for [begin, end).
  template <class Use>
  void for_range(int begin, int end, const Positions& x, const Use& use) const;
  void take_parts();

  std::string name_;
  StencilPlaces places_;
  std::vector<bool> pinned_;  // that parts leave out; empty: none
  double stiffness_, scale_ = 1.0;
  Law law_;
  std::vector<int> particles_, begins_, entries_;  // of each particle, its entries of all parts
  std::vector<int> owners_;                        // the part of each entry
  mutable std::vector<Eigen::Matrix3d> stresses_;  // weighted, of all parts [J]
  std::vector<Eigen::Matrix3d> multipliers_;       // [J]
};

extern template class StencilSet<ShearLaw>;
extern template class StencilSet<PressureLaw>;

/// Kelvin-Voigt damping of a StencilSet with time β [s]: of a step h the dissipation
///   E = β/h Σ stiffness volume Ψ(G),
/// Ψ from the stretches at the step's beginning, so that its forces are those of a viscosity β
/// times the stiffness. They are functions of stretches alone: rigid motions feel none, and
/// momentum and angular momentum are kept. Integrations of second order go on from what the
/// stretches would be had they changed as in the step before (InertialStart).
template <class Law>
class ViscousStencilSet final : public StencilSet<Law> {
 public:
  ViscousStencilSet(StencilPlaces places, double stiffness, double time)
      : StencilSet<Law>(std::string(kMaterialDamping), std::move(places), stiffness), time_(time) {
    this->law().resize(this->size());
  }
  bool is_viscous() const override { return true; }
  void prepare(double step) override { this->set_scale(time_ / step); }
  void begin_step(const Particles& particles) override;
  void add_damping(double, std::vector<std::unique_ptr<ElementSet>>&) const override {}

 private:
  double time_;  // [s]
};

extern template class ViscousStencilSet<ShearLaw>;
extern template class ViscousStencilSet<PressureLaw>;

}  // namespace pliant
