#pragma once

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/effect.h"

namespace pliant {

template <typename T>
class SphKernels;

/// Velocities of liquid neighbours draw near each other (XSPH, Monaghan 1989), as impulses between
/// pairs: m dvᵢ/dt = rate Σⱼ m̄ V̄ W (vⱼ − vᵢ). Takes the jitter out of a liquid that hardly has a
/// viscosity; momentum is kept.
class XsphEffect final : public Effect {
 public:
  XsphEffect(BlendedParticles& blend, double rate) : blend_(blend), rate_(rate) {}
  std::string_view name() const override { return "xsph"; }
  void after_step(Body& body, double dt) override;
  bool join_resident_run(ResidentRun& run) const override;

 private:
  double share(double dt) const;
  void sum_pairs(const Particles& particles);
  /// What a whole share took of each particle's motion, half of a pair's to either [J].
  Eigen::VectorXd losses(const Particles& particles, const Eigen::Matrix3Xd& before);
  /// Of the velocity's difference between two particles [kg].
  double weight(const Particles& particles, const SphKernels<double>& kernels, int i, int o) const;

  BlendedParticles& blend_;
  double rate_;              // [1/s]
  Eigen::Matrix3Xd change_;  // of momentum, over the share [kg m/s]
};

EffectRegistry::Entry xsph_entry();

}  // namespace pliant
