#pragma once

#include <memory>

#include "pliant/effects/pair_contact_effect.h"

namespace pliant {

/// Keeps the bodies of a group out of each other. The first of them holds it for all.
class BodyContactEffect final : public PairContactEffect {
 public:
  BodyContactEffect(std::unique_ptr<PairDetection> detection, double thickness);
  std::string_view name() const override { return "body_contact"; }
  Coupling* constraint_between_bodies() override { return this; }

 private:
  std::string_view held_back() const override;
  std::string_view search_phase() const override { return "body_contact_search"; }
  std::string_view phase() const override { return name(); }
};

EffectRegistry::Entry body_contact_entry();

}  // namespace pliant
