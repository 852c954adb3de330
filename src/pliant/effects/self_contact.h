#pragma once

#include <memory>

#include "pliant/effects/pair_contact_effect.h"

namespace pliant {

/// Keeps the parts of a body out of each other and each part out of itself.
class SelfContactEffect final : public PairContactEffect {
 public:
  SelfContactEffect(std::unique_ptr<PairDetection> detection, double thickness);
  std::string_view name() const override { return "self_contact"; }
  Coupling* coupling() override { return this; }
  void before_step(Body& body, double dt) override;

  /// Water at the particles from now on; `wet` outlives this.
  void moisten(const WetContact* wet) {
    is_wet_ = wet != nullptr;
    detection().moisten(wet);
  }
  bool is_wet() const { return is_wet_; }

 private:
  std::string_view held_back() const override;
  std::string_view search_phase() const override { return "self_contact_search"; }
  std::string_view phase() const override { return name(); }

  bool is_wet_ = false;
  bool is_on_gpu_ = false;  // the solver
};

EffectRegistry::Entry self_contact_entry();

}  // namespace pliant
