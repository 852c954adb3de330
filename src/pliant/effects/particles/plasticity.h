#pragma once

#include "pliant/core/body/blended_particles.h"
#include "pliant/core/effect.h"

namespace pliant {

/// Solids that keep what deforms them: where the particles of a group that holds together are
/// further from its shape than `yield` of its size, the shape follows them at a rate. With a yield
/// of 0 it creeps under any load. Elastic energy only falls by it.
class PlasticityEffect final : public Effect {
 public:
  PlasticityEffect(BlendedParticles& blend, double yield, double rate)
      : blend_(blend), yield_(yield), rate_(rate) {}
  std::string_view name() const override { return "plasticity"; }
  void after_step(Body& body, double dt) override;
  bool remembers_steps() const override { return true; }

 private:
  BlendedParticles& blend_;
  double yield_;
  double rate_;  // [1/s]
};

EffectRegistry::Entry plasticity_entry();

}  // namespace pliant
