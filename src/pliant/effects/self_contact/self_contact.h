#pragma once

#include <memory>
#include <string>

#include "pliant/effects/contact/pair_contact_effect.h"

namespace pliant {

/// Keeps the parts of a body out of each other and each part out of itself.
class SelfContactEffect final : public PairContactEffect, public TakesWetness {
 public:
  SelfContactEffect(std::unique_ptr<PairDetection> detection, double thickness);
  std::string_view name() const override { return "self_contact"; }
  Constraint* constraint() override { return this; }
  void before_step(Body& body, double dt) override;
  void report(StepReport& report) const override;

  void set_wetness(const WetContact* wet) override {
    is_wet_ = wet != nullptr;
    detection().set_wetness(wet);
  }
  bool is_wet() const { return is_wet_; }

 protected:
  void* offer(const std::type_info& type) override {
    return offer_as<SelfContactEffect, PairContactEffect, TakesWetness>(this, type);
  }

 private:
  std::string_view held_back() const override;
  std::string_view search_phase() const override { return "self_contact_search"; }
  std::string_view phase() const override { return name(); }

  std::string body_;  // the name of its body
  bool is_wet_ = false;
  bool is_on_gpu_ = false;  // the solver
};

EffectRegistry::Entry self_contact_entry();

}  // namespace pliant
