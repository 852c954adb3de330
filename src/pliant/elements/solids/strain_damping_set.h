#pragma once

#include <array>
#include <vector>

#include "pliant/core/system/element_set.h"

namespace pliant {

/// A strain of sheets and yarns, a number s(x) that no rigid motion changes. `first` and `second`
/// are weights of the particles, as many as these, that add up to nothing; `second` may be empty.
struct StrainMeasure {
  enum Kind {
    kLength,  ///< |Σ first x| − |Σ second x|
    kCurvature,  ///< (Σ first x)·n, n the unit normal of (x₁ − x₀) × (x₃ − x₂) of `normal`
  };
  Kind kind = kLength;
  static constexpr int kMostParticles = 128;
  std::vector<int> particles;
  std::vector<double> first, second;
  std::array<int, 4> normal = {0, 1, 2, 3};  ///< places in `particles`
  double stiffness = 0.0;                    ///< k of 1/2 k s²
};

/// Kelvin-Voigt damping with time β [s] of strains whose energies are 1/2 k (s − s₀)²: of a step h
///   E = 1/2 β/h Σ k (s(x) − s)²,
/// s the strain at the step's beginning. Momentum and angular momentum are kept, since strains feel
/// no rigid motion. Integrations of second order go on from what strains would be had they changed
/// as in the step before. The stiffness is that of Gauss and Newton, k β/h ∇s ∇sᵀ: what it lacks is
/// as small as the change of a strain in a step.
class StrainDampingSet final : public ElementSet {
 public:
  StrainDampingSet(const std::vector<StrainMeasure>& strains, double time);

  std::string_view name() const override { return kMaterialDamping; }
  int size() const override { return static_cast<int>(strains_.size()); }
  bool is_viscous() const override { return true; }
  void prepare(double step) override { scale_ = time_ / step; }
  void begin_step(const Particles& particles) override;
  double energy(const Positions& x) const override;
  void add_forces(const Positions& x, Forces& f) const override;
  void add_to_system(SystemMatrix& a) const override;
  void add_stiffness(const Positions& x, Definiteness definiteness,
                     StiffnessMatrix& k) const override;
  void reset_multipliers() override;
  void relax(const Eigen::VectorXd& inverse_mass, double dt, Positions& x) override;

 private:
  std::vector<StrainMeasure> strains_;
  double time_, scale_ = 0.0;
  std::vector<double> remembered_, multipliers_;
};

}  // namespace pliant
