#pragma once

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/effect.h"

namespace pliant {

/// Particles attract each other with the potential −A Vᵢ Vⱼ W, W the kernel poly6. Cutting a liquid
/// apart then costs, per area of the two new surfaces, π/2 ∫ A W r³ dr = 63/1024 A H: A is chosen
/// such that this is the surface tension. Momentum is kept, and energy to the integrator's order.
class SurfaceTensionEffect final : public Effect {
 public:
  SurfaceTensionEffect(BlendedParticles& blend, double tension)
      : blend_(blend), tension_(tension) {}
  std::string_view name() const override { return "surface_tension"; }
  void before_step(Body& body, double dt) override;
  bool join_resident_run(ResidentRun& run) const override;
  double potential_energy(const Body& body) const override;

 private:
  double strength() const;  ///< A [Pa]
  void sum_pairs(const Positions& x);

  BlendedParticles& blend_;
  double tension_;         // [N/m]
  Eigen::Matrix3Xd sums_;  // Σ min(β) V V ∇W [m²]
};

EffectRegistry::Entry surface_tension_entry();

}  // namespace pliant
