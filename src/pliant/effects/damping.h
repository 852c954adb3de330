#pragma once

#include "pliant/core/effect.h"

namespace pliant {

/// Mass-proportional damping, dv/dt = -rate v, integrated exactly.
class DampingEffect final : public Effect {
 public:
  explicit DampingEffect(double rate) : rate_(rate) {}
  std::string_view name() const override { return "damping"; }
  void after_step(Body& body, double dt) override;
  bool join_resident_run(ResidentRun& run) const override;

 private:
  double rate_;  // [1/s]
};

EffectRegistry::Entry damping_entry();

}  // namespace pliant
